#include <tope/common/error.hpp>
#include <tope/limit/joint_limits.hpp>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

void require_positive(const std::string& what, double value) {
  if (!std::isfinite(value) || value <= 0.0) {
    throw ConfigError("limits: " + what + " must be positive and finite, got " + std::to_string(value));
  }
}

}  // namespace

JointLimits::JointLimits(const Robot& robot, const JointLimitOptions& options)
    : options_(options),
      lower_(robot.position_lower()),
      upper_(robot.position_upper()),
      velocity_limit_(robot.velocity_limit()),
      buffer_(Vector::Constant(robot.nv(), options.buffer)),
      activation_(Vector::Zero(robot.nv())),
      target_(Vector::Zero(robot.nv())),
      side_(Vector::Zero(robot.nv())),
      motion_lower_(Vector::Zero(robot.nv())),
      motion_upper_(Vector::Zero(robot.nv())) {
  require_positive("buffer", options.buffer);
  require_positive("gain", options.gain);
  require_positive("margin", options.margin);
  for (const auto& [joint, buffer] : options.buffers) {
    require_positive("buffer of " + joint, buffer);
    buffer_[robot.joint_index(joint)] = buffer;
  }
  for (int j = 0; j < size(); ++j) {
    const double range = upper_[j] - lower_[j];
    const double needed = 2.0 * std::max(buffer_[j], options.margin);
    if (range <= needed) {
      throw ConfigError("limits: the buffers of " + robot.joint_names()[static_cast<std::size_t>(j)] +
                        " overlap: its range " + std::to_string(range) +
                        " must exceed twice its buffer (and margin), " + std::to_string(needed) +
                        "; lower its buffer below " + std::to_string(0.5 * range));
    }
  }
}

bool JointLimits::limited(int joint) const {
  return std::isfinite(lower_[joint]) || std::isfinite(upper_[joint]);
}

void JointLimits::update(const VectorArg& q) {
  double furthest = 0.0;
  beyond_ = -1;
  for (int j = 0; j < size(); ++j) {
    const double to_upper = upper_[j] - q[j];
    const double to_lower = q[j] - lower_[j];
    const double distance = std::min(to_upper, to_lower);
    side_[j] = to_upper <= to_lower ? 1.0 : -1.0;
    activation_[j] = ramp(options_.ramp, 1.0 - distance / buffer_[j]);
    target_[j] = std::isfinite(distance) ? side_[j] * options_.gain * (distance - buffer_[j]) : 0.0;

    const double v_max = velocity_limit_[j];
    motion_upper_[j] = std::clamp(options_.gain * (to_upper - options_.margin), -0.5 * v_max, v_max);
    motion_lower_[j] = -std::clamp(options_.gain * (to_lower - options_.margin), -0.5 * v_max, v_max);
    if (-distance > furthest) {
      furthest = -distance;
      beyond_ = j;
    }
  }
}

void JointLimits::blended_speed_bounds(const Vector& activation, Vector& lower, Vector& upper) const {
  lower = -velocity_limit_;
  upper = velocity_limit_;
  for (int j = 0; j < size(); ++j) {
    Vector& near = side_[j] > 0.0 ? upper : lower;
    const double xi = activation[j];
    near[j] = xi < 1.0 ? (1.0 - xi) * near[j] + xi * target_[j] : target_[j];  // v_max may be infinite
  }
}

void JointLimits::engagement(const VectorArg& v, Eigen::Ref<Vector> upper, Eigen::Ref<Vector> lower) const {
  for (int j = 0; j < size(); ++j) {
    const double scale = options_.gain * buffer_[j];
    // a bound that only the speed limit sets is none of a position limit's
    const bool near_upper = std::isfinite(upper_[j]) && motion_upper_[j] < velocity_limit_[j];
    const bool near_lower = std::isfinite(lower_[j]) && motion_lower_[j] > -velocity_limit_[j];
    upper[j] = near_upper ? ramp(options_.ramp, 1.0 - (motion_upper_[j] - v[j]) / scale) : 0.0;
    lower[j] = near_lower ? ramp(options_.ramp, 1.0 - (v[j] - motion_lower_[j]) / scale) : 0.0;
  }
}

void JointLimits::activation_by_side(Eigen::Ref<Vector> upper, Eigen::Ref<Vector> lower) const {
  upper = (side_.array() > 0.0).select(activation_, 0.0);
  lower = (side_.array() < 0.0).select(activation_, 0.0);
}

}  // namespace tope
