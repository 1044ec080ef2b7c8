#include <tope/common/error.hpp>
#include <tope/limit/potential_field.hpp>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

constexpr double kSmallestDistance = 1e-2;  // of the influence; the field is constant from here on

}  // namespace

PotentialField::PotentialField(const Robot& robot, const PotentialFieldOptions& options)
    : options_(options),
      lower_(robot.position_lower()),
      upper_(robot.position_upper()),
      repels_(static_cast<std::size_t>(robot.nv()), options.joints.empty() ? 1 : 0),
      motion_(Vector::Zero(robot.nv())) {
  if (!(options.influence > 0.0) || !(options.strength > 0.0)) {
    throw ConfigError("potential_field: influence and strength must be positive, got " +
                      std::to_string(options.influence) + " and " + std::to_string(options.strength));
  }
  for (const std::string& name : options.joints) {
    const int joint = robot.joint_index(name);
    if (!std::isfinite(lower_[joint]) && !std::isfinite(upper_[joint])) {
      throw ConfigError("potential_field: joint '" + name + "' has no limit that could repel");
    }
    repels_[static_cast<std::size_t>(joint)] = 1;
  }
}

double PotentialField::repulsion(double distance) const {
  const double s = std::max(distance / options_.influence, kSmallestDistance);
  return s < 1.0 ? options_.strength * (1.0 / s - 1.0) / (s * s) : 0.0;
}

void PotentialField::update(const VectorArg& q) {
  for (Eigen::Index j = 0; j < motion_.size(); ++j) {
    motion_[j] =
        repels(static_cast<int>(j)) ? repulsion(q[j] - lower_[j]) - repulsion(upper_[j] - q[j]) : 0.0;
  }
  in_range_ = motion_.cwiseAbs().maxCoeff() > 0.0;
}

}  // namespace tope
