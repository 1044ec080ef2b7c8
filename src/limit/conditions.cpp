#include <tope/limit/conditions.hpp>

#include <algorithm>
#include <sstream>

namespace tope {
namespace {

template <typename... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream stream;
  stream.precision(4);
  (stream << ... << parts);
  return stream.str();
}

Condition servo_is_stable(const JointLimitOptions& options, double dt) {
  return {.name = "limit servo within one period",
          .joint = "",
          .expression = "dt * gain <= 1",
          .value = dt * options.gain,
          .bound = 1.0,
          .advice = text("lower limits.gain to at most ", 1.0 / dt, " 1/s or dt to at most ",
                         1.0 / options.gain, " s")};
}

/// A joint at full speed must not cross its buffer between two samples; kappa is the ramp's steepness.
Condition buffer_is_wide(const Robot& robot, const JointLimits& limits, int joint, double kappa, double dt) {
  const std::string& name = robot.joint_names()[static_cast<std::size_t>(joint)];
  const double speed = limits.velocity_limit()[joint];
  const std::string& unit = robot.joint_unit(joint);
  return {.name = "buffer wide enough for the period",
          .joint = name,
          .expression = "kappa * dt * v_max <= buffer",
          .value = kappa * dt * speed,
          .bound = limits.buffer(joint),
          .advice = text("raise the buffer of ", name, " to at least ", kappa * dt * speed, " ", unit,
                         " or lower dt to at most ", limits.buffer(joint) / (kappa * speed), " s")};
}

/// The tightened bounds of the unilateral law must leave an interior.
Condition headroom_fits(const Robot& robot, const JointLimits& limits, int joint, double headroom) {
  const std::string& name = robot.joint_names()[static_cast<std::size_t>(joint)];
  const JointLimitOptions& options = limits.options();
  const double range = limits.upper()[joint] - limits.lower()[joint] - 2.0 * options.margin;
  const double width = std::min(options.gain * range, 0.5 * limits.velocity_limit()[joint]);
  return {.name = "headroom inside the bounds",
          .joint = name,
          .expression = "2 * headroom <= min(gain * (range - 2 margin), v_max / 2)",
          .value = 2.0 * headroom,
          .bound = width,
          .advice = text("lower limits.unilateral.headroom to at most ", 0.5 * width)};
}

}  // namespace

std::vector<Condition> velocity_conditions(const Robot& robot, const JointLimits& limits, LimitMethod method,
                                           double headroom, double dt) {
  std::vector<Condition> conditions;
  if (method == LimitMethod::none) {
    return conditions;
  }
  conditions.push_back(servo_is_stable(limits.options(), dt));
  // a switched or literal row is complete from the buffer's edge on, and needs no more than one period's
  // travel
  const bool blended = method == LimitMethod::chain || method == LimitMethod::multilinear ||
                       method == LimitMethod::intermediate;
  const double kappa = blended ? ramp_slope_factor(limits.options().ramp) : 1.0;
  for (int joint = 0; joint < limits.size(); ++joint) {
    if (!limits.limited(joint)) {
      continue;
    }
    conditions.push_back(method == LimitMethod::unilateral ? headroom_fits(robot, limits, joint, headroom)
                                                           : buffer_is_wide(robot, limits, joint, kappa, dt));
  }
  return conditions;
}

}  // namespace tope
