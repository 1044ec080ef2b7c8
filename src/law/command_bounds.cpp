#include <tope/law/command_bounds.hpp>

#include <algorithm>
#include <cmath>

namespace tope {

CommandBounds CommandBounds::apply(const Vector& bound, Vector& first, Vector& command) {
  CommandBounds result;
  command -= first;  // the tasks' share
  for (Eigen::Index j = 0; j < bound.size(); ++j) {
    if (std::abs(first[j]) > bound[j]) {
      first[j] = std::copysign(bound[j], first[j]);
      result.clipped = static_cast<int>(j);
    }
    const double share = std::abs(command[j]);
    const double room = command[j] > 0.0 ? bound[j] - first[j] : bound[j] + first[j];
    if (share > 0.0 && room < result.scale * share) {
      result.scale = room / share;
      result.most_binding = static_cast<int>(j);
    }
  }
  command = first + result.scale * command;
  return result;
}

}  // namespace tope
