#include <tope/limit/conditions.hpp>
#include <tope/robot/sampled_pose.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
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

/// `what` names the limits: "limit" or "distance"; `key` is where their gains are set.
Condition servo_is_stable(const std::string& what, const std::string& key, double gain, double dt) {
  return {.name = what + " servo within one period",
          .joint = "",
          .expression = "dt * gain <= 1",
          .value = dt * gain,
          .bound = 1.0,
          .advice =
              text("lower ", key, ".gain to at most ", 1.0 / dt, " 1/s or dt to at most ", 1.0 / gain, " s")};
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

/// Least distance between the bounds that the unilateral law keeps a joint's motion in.
double width_of_bounds(const JointLimits& limits, int joint) {
  const double range = limits.upper()[joint] - limits.lower()[joint] - 2.0 * limits.options().margin;
  return std::min(limits.gain(joint) * range, 0.5 * limits.velocity_limit()[joint]);
}

double second_order_width_of_bounds(const JointLimits& limits, int joint) {
  const double range = limits.upper()[joint] - limits.lower()[joint];
  return limits.options().servo_gain * limits.allowed_speed(joint, 0.5 * range - limits.options().margin);
}

/// The tightened bounds of the unilateral law must leave an interior.
Condition headroom_fits(const Robot& robot, const JointLimits& limits, int joint, double headroom) {
  const std::string& name = robot.joint_names()[static_cast<std::size_t>(joint)];
  const double width = width_of_bounds(limits, joint);
  return {.name = "headroom inside the bounds",
          .joint = name,
          .expression = "2 * headroom <= min(gain * (range - 2 margin), v_max / 2)",
          .value = 2.0 * headroom,
          .bound = width,
          .advice = text("lower limits.unilateral.headroom to at most ", 0.5 * width)};
}

Condition second_order_servo_is_stable(const std::string& what, const std::string& key, double gain,
                                       double servo_gain, double dt) {
  const double c = 1.0 + 0.5 * gain * dt;
  return {.name = what + " servo within one period",
          .joint = "",
          .expression = "dt * (1 + gain dt / 2) * servo_gain <= 1",
          .value = dt * c * servo_gain,
          .bound = 1.0,
          .advice = text("lower ", key, ".servo_gain to at most ", 1.0 / (c * dt), " 1/s")};
}

constexpr double kRowsApart = 0.9;  // of v_max

/// Away from its limits a joint at rest must be outside both of its rows.
Condition rows_apart(const Robot& robot, const JointLimits& limits, int joint) {
  const std::string& name = robot.joint_names()[static_cast<std::size_t>(joint)];
  const double speed = limits.velocity_limit()[joint];
  const double gain = limits.gain(joint);
  return {.name = "rows idle at rest",
          .joint = name,
          .expression = "gain * buffer <= 0.9 v_max",
          .value = gain * limits.buffer(joint),
          .bound = kRowsApart * speed,
          .advice = text("lower the buffer of ", name, " to at most ", kRowsApart * speed / gain, " ",
                         robot.joint_unit(joint), " or limits.gain to at most ",
                         kRowsApart * speed / limits.buffer(joint), " 1/s")};
}

/// A joint at full speed that is accelerated as hard as its row can brake must not cross its buffer in a period.
Condition second_order_buffer_is_wide(const Robot& robot, const JointLimits& limits, int joint, double dt) {
  const std::string& name = robot.joint_names()[static_cast<std::size_t>(joint)];
  const JointLimitOptions& options = limits.options();
  const double kappa = ramp_slope_factor(options.ramp);
  const double gain = limits.gain(joint);
  const double c = 1.0 + 0.5 * gain * dt;
  const double speed = limits.velocity_limit()[joint];
  const double buffer = limits.buffer(joint);
  const double acceleration = gain * (speed + options.servo_gain * buffer);
  const double shrink = 1.0 - 0.5 * gain * gain * dt * dt;
  const double needed = kappa * dt * (speed + c * acceleration / gain);
  return {
      .name = "buffer wide enough for the period",
      .joint = name,
      .expression =
          "kappa * dt * (v_max + c A / gain) <= buffer * (1 - (gain dt)^2 / 2), A = gain (v_max + "
          "servo_gain buffer), c = 1 + gain dt / 2",
      .value = needed,
      .bound = buffer * shrink,
      .advice = text("raise the buffer of ", name, " above ", needed / shrink, " ", robot.joint_unit(joint),
                     " or lower dt below ", dt * buffer * shrink / needed, " s")};
}

Condition second_order_headroom_fits(const Robot& robot, const JointLimits& limits, int joint,
                                     double headroom) {
  const std::string& name = robot.joint_names()[static_cast<std::size_t>(joint)];
  const double width = second_order_width_of_bounds(limits, joint);
  return {.name = "headroom inside the bounds",
          .joint = name,
          .expression = "2 * headroom <= servo_gain * V(range / 2 - margin)",
          .value = 2.0 * headroom,
          .bound = width,
          .advice = text("lower limits.unilateral.headroom to at most ", 0.5 * width)};
}

/// Below, a joint's two bounds contradict each other at speeds that each allows: docs/theory.md, 5.7.
Condition servo_keeps_up(const JointLimits& limits) {
  return {.name = "servo as fast as the limits",
          .joint = "",
          .expression = "gain <= servo_gain",
          .value = limits.largest_gain(),
          .bound = limits.options().servo_gain,
          .advice = text("raise limits.servo_gain to at least ", limits.largest_gain(), " 1/s")};
}

/// What a limit row asks of a joint's drive, over the gain: the speed lost per 1 / gain.
double braking_speed(const JointLimits& limits, LimitMethod method, int joint) {
  const double by_row =
      method == LimitMethod::unilateral ? 0.0 : limits.options().servo_gain * limits.buffer(joint);
  return limits.velocity_limit()[joint] + by_row;
}

Condition drive_can_brake(const Robot& robot, const JointLimits& limits, LimitMethod method, int joint,
                          double authority) {
  const std::string& name = robot.joint_names()[static_cast<std::size_t>(joint)];
  const double speed = braking_speed(limits, method, joint);
  const bool rows = method != LimitMethod::unilateral;
  return {.name = "drive strong enough to brake",
          .joint = name,
          .expression = std::string(rows ? "gain * (v_max + servo_gain * buffer)" : "gain * v_max") +
                        " <= (effort - |gravity|) / inertia in the worst pose",
          .value = limits.gain(joint) * speed,
          .bound = authority,
          .advice =
              authority > 0.0
                  ? text("lower limits.gain to at most ", authority / speed, " 1/s",
                         rows ? ", or limits.servo_gain, or the buffer" : "", " or the speed limit of ", name)
                  : text("in some pose the drive of ", name,
                         " cannot hold the robot against gravity; raise its effort limit or narrow the "
                         "position limits")};
}

}  // namespace

double braking_gain(const JointLimits& limits, LimitMethod method, int joint, double authority) {
  constexpr double share = 0.8;  // the rest is for speed-dependent forces and joints that brake at once
  constexpr double poles =
      0.4;  // gain over servo_gain: closer, and a joint that presses on its limit shakes with friction
  double gain = std::min(JointLimits::default_gain, poles * limits.options().servo_gain);
  if (!limits.limited(joint) || !(authority > 0.0)) {
    return gain;
  }
  gain = std::min(gain, share * authority / braking_speed(limits, method, joint));
  return method == LimitMethod::unilateral
             ? gain
             : std::min(gain, kRowsApart * limits.velocity_limit()[joint] / limits.buffer(joint));
}

double suitable_headroom(const JointLimits& limits, int joint, bool second_order, double most) {
  constexpr double share = 0.25;  // half of what the inequality below allows
  if (!limits.limited(joint)) {
    return most;
  }
  const double width =
      second_order ? second_order_width_of_bounds(limits, joint) : width_of_bounds(limits, joint);
  return std::min(most, share * width);
}

std::vector<Condition> velocity_conditions(const Robot& robot, const JointLimits& limits, LimitMethod method,
                                           const Vector& headroom, double dt) {
  std::vector<Condition> conditions;
  if (method == LimitMethod::none) {
    return conditions;
  }
  conditions.push_back(servo_is_stable("limit", "limits", limits.largest_gain(), dt));
  // a switched or literal row is complete from the buffer's edge on, and needs no more than one period's
  // travel
  const bool blended = method == LimitMethod::chain || method == LimitMethod::multilinear ||
                       method == LimitMethod::intermediate;
  const double kappa = blended ? ramp_slope_factor(limits.options().ramp) : 1.0;
  for (int joint = 0; joint < limits.size(); ++joint) {
    if (!limits.limited(joint)) {
      continue;
    }
    conditions.push_back(method == LimitMethod::unilateral
                             ? headroom_fits(robot, limits, joint, headroom[joint])
                             : buffer_is_wide(robot, limits, joint, kappa, dt));
  }
  return conditions;
}

std::vector<Condition> torque_conditions(const Robot& robot, const JointLimits& limits, LimitMethod method,
                                         const Vector& headroom, double dt, const Vector& authority) {
  std::vector<Condition> conditions;
  if (method == LimitMethod::none) {
    return conditions;
  }
  conditions.push_back(second_order_servo_is_stable("limit", "limits", limits.largest_gain(),
                                                    limits.options().servo_gain, dt));
  if (method == LimitMethod::unilateral) {
    conditions.push_back(servo_keeps_up(limits));
  }
  for (int joint = 0; joint < limits.size(); ++joint) {
    if (!limits.limited(joint)) {
      continue;
    }
    if (method == LimitMethod::unilateral) {
      conditions.push_back(second_order_headroom_fits(robot, limits, joint, headroom[joint]));
    } else {
      conditions.push_back(rows_apart(robot, limits, joint));
      conditions.push_back(second_order_buffer_is_wide(robot, limits, joint, dt));
    }
    conditions.push_back(drive_can_brake(robot, limits, method, joint, authority[joint]));
  }
  return conditions;
}

double full_speed_drift(const Robot& robot, CollisionLimits& collisions) {
  if (!robot.velocity_limit().allFinite()) {
    return std::numeric_limits<double>::infinity();
  }
  RobotTerms terms(robot);
  double largest = 0.0;
  for (int k = 0; k < sampled_poses; ++k) {
    Vector v = robot.velocity_limit();
    for (unsigned j = 0; j < v.size(); ++j) {  // every pattern of signs in turn, of up to eight joints
      v[j] *= (static_cast<unsigned>(k) >> (j % 8U)) % 2U == 0U ? 1.0 : -1.0;
    }
    terms.update_dynamics(sampled_pose(robot, k), v);
    collisions.update_second_order(terms);
    largest = std::max(largest, collisions.drift());
  }
  return largest;
}

std::vector<Condition> velocity_conditions(const CollisionLimits& collisions, double drift, double dt) {
  const double bent = 0.5 * dt * drift / collisions.gain();
  std::vector<Condition> conditions{servo_is_stable("distance", "collisions", collisions.gain(), dt)};
  if (std::isfinite(drift)) {
    conditions.push_back(
        {.name = "margin covers a period",
         .joint = "",
         .expression = "dt * drift / (2 gain) <= margin, drift at full speed in the worst pose",
         .value = bent,
         .bound = collisions.margin(),
         .advice = text("raise collisions.margin to at least ", bent, " m or lower dt to at most ",
                        dt * collisions.margin() / bent, " s")});
  }
  return conditions;
}

/// All joints that slow down at their limits' gain slow every approach down at that gain, which is what their drives are
/// known to manage; a distance must not ask for more.
std::vector<Condition> torque_conditions(const CollisionLimits& collisions, const JointLimits& limits,
                                         double dt) {
  return {
      second_order_servo_is_stable("distance", "collisions", collisions.gain(), collisions.servo_gain(), dt),
      {.name = "drives strong enough for the distances",
       .joint = "",
       .expression = "collisions.gain <= limits.gain",
       .value = collisions.gain(),
       .bound = limits.least_gain(),
       .advice = text("lower collisions.gain to at most ", limits.least_gain(), " 1/s")}};
}

}  // namespace tope
