#include <tope/law/command_bounds.hpp>

#include <algorithm>

namespace tope {
namespace {

// A share this far beyond its room is rounding, and must not stop the robot. [units of the command]
constexpr double kRounding = 1e-9;

}  // namespace

CommandBounds CommandBounds::apply(const Vector& lower, const Vector& upper, Vector& first, Vector& command) {
  CommandBounds result;
  command -= first;  // the tasks' share
  for (Eigen::Index j = 0; j < lower.size(); ++j) {
    if (first[j] > upper[j] + kRounding || first[j] < lower[j] - kRounding) {
      first[j] = std::clamp(first[j], lower[j], upper[j]);
      result.clipped = static_cast<int>(j);
    }
    const double share = command[j];
    const double room = std::max(0.0, share > 0.0 ? upper[j] - first[j] : first[j] - lower[j]);
    const double size = share > 0.0 ? share : -share;
    if (size > room + kRounding && room < result.scale * size) {
      result.scale = room / size;
      result.most_binding = static_cast<int>(j);
    }
  }
  command = first + result.scale * command;
  return result;
}

}  // namespace tope
