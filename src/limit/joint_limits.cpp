#include "../common/require_positive.hpp"

#include <tope/common/error.hpp>
#include <tope/limit/joint_limits.hpp>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

constexpr double kEnvelopeRounding = 0.1;  // radius of the envelope's corner, of the speed where it is
/// sqrt(1 + rounding^2): what the rounding adds where the straight part is at zero.
const double kEnvelopeAtZero = std::sqrt(1.0 + kEnvelopeRounding * kEnvelopeRounding);

}  // namespace

JointLimits::JointLimits(const Robot& robot, const JointLimitOptions& options)
    : options_(options),
      gain_(Vector::Constant(robot.nv(), options.gain.value_or(default_gain))),
      lower_(robot.position_lower()),
      upper_(robot.position_upper()),
      lower_rate_(Vector::Zero(robot.nv())),
      upper_rate_(Vector::Zero(robot.nv())),
      velocity_limit_(robot.velocity_limit()),
      buffer_(Vector::Constant(robot.nv(), options.buffer)),
      activation_(Vector::Zero(robot.nv())),
      target_(Vector::Zero(robot.nv())),
      side_(Vector::Zero(robot.nv())),
      motion_lower_(Vector::Zero(robot.nv())),
      motion_upper_(Vector::Zero(robot.nv())),
      lower_at_rest_(Vector::Zero(robot.nv())),
      upper_at_rest_(Vector::Zero(robot.nv())),
      near_upper_(static_cast<std::size_t>(robot.nv()), 0),
      near_lower_(static_cast<std::size_t>(robot.nv()), 0),
      engagement_slack_(Vector::Zero(robot.nv())) {
  require_positive("limits: buffer", options.buffer);
  require_positive("limits: gain", options.gain.value_or(default_gain));
  require_positive("limits: servo_gain", options.servo_gain);
  require_positive("limits: margin", options.margin);
  for (const auto& [joint, buffer] : options.buffers) {
    require_positive("limits: buffer of " + joint, buffer);
    buffer_[robot.joint_index(joint)] = buffer;
  }
  for (const auto& [joint, gain] : options.gains) {
    require_positive("limits: gain of " + joint, gain);
    gain_[robot.joint_index(joint)] = gain;
  }
  for (int j = 0; j < size(); ++j) {
    const double range = upper_[j] - lower_[j];
    const double needed = range_needed(j);
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

double JointLimits::range_needed(int joint) const { return 2.0 * std::max(buffer_[joint], options_.margin); }

bool JointLimits::move(int joint, const LimitMotion& motion) {
  if (joint < 0 || joint >= size() || !std::isfinite(motion.lower_rate) ||
      !std::isfinite(motion.upper_rate) || !(motion.upper - motion.lower > range_needed(joint))) {
    return false;
  }
  lower_[joint] = motion.lower;
  upper_[joint] = motion.upper;
  lower_rate_[joint] = motion.lower_rate;
  upper_rate_[joint] = motion.upper_rate;
  return true;
}

/// Fills what is asked for, joint by joint, from the distances to the upper and the lower limit.
template <typename FillRow, typename FillBounds>
void JointLimits::fill(const VectorArg& q, Part part, FillRow row, FillBounds bounds) {
  beyond_ = -1;
  furthest_beyond_ = 0.0;
  for (int j = 0; j < size(); ++j) {
    const double to_upper = upper_[j] - q[j];
    const double to_lower = q[j] - lower_[j];
    note_beyond(j, std::min(to_upper, to_lower));
    if (part != Part::bounds) {
      row(j, to_upper, to_lower);
    }
    if (part != Part::rows) {
      bounds(j, to_upper, to_lower);
    }
  }
}

void JointLimits::update(const VectorArg& q, Part part) {
  fill(
      q, part, [this](int j, double to_upper, double to_lower) { fill_row(j, to_upper, to_lower); },
      [this](int j, double to_upper, double to_lower) { fill_bounds(j, to_upper, to_lower); });
  engagement_slack_ = gain_.cwiseProduct(buffer_);
}

void JointLimits::fill_row(int j, double to_upper, double to_lower) {
  const double distance = std::min(to_upper, to_lower);
  side_[j] = to_upper <= to_lower ? 1.0 : -1.0;
  activation_[j] = ramp(options_.ramp, 1.0 - distance / buffer_[j]);
  const double rate = side_[j] > 0.0 ? upper_rate_[j] : lower_rate_[j];
  const double v_max = velocity_limit_[j];
  // far beyond a limit the row would lead back faster than the joint may move
  target_[j] = std::isfinite(distance)
                   ? std::clamp(side_[j] * gain_[j] * (distance - buffer_[j]) + rate, -v_max, v_max)
                   : 0.0;
}

void JointLimits::fill_bounds(int j, double to_upper, double to_lower) {
  const double v_max = velocity_limit_[j];
  const double ahead = gain_[j] * (to_upper - options_.margin) + upper_receding(j);
  const double behind = gain_[j] * (to_lower - options_.margin) + lower_receding(j);
  motion_upper_[j] = std::clamp(ahead, -0.5 * v_max, v_max);
  motion_lower_[j] = -std::clamp(behind, -0.5 * v_max, v_max);
  upper_at_rest_[j] = std::max(0.0, motion_upper_[j]);
  lower_at_rest_[j] = std::max(0.0, -motion_lower_[j]);
  note_near(j, ahead, behind);
}

/// Whether position limits or the speed limit set the bounds, by what the first ones allow.
void JointLimits::note_near(int joint, double ahead, double behind) {
  const auto k = static_cast<std::size_t>(joint);
  near_upper_[k] = ahead < velocity_limit_[joint] ? 1 : 0;
  near_lower_[k] = behind < velocity_limit_[joint] ? 1 : 0;
}

void JointLimits::note_beyond(int joint, double distance) {
  if (-distance > furthest_beyond_) {
    furthest_beyond_ = -distance;
    beyond_ = joint;
  }
}

JointLimits::Envelope JointLimits::envelope(int joint, double distance, double receding) const {
  const double v_max = velocity_limit_[joint];
  if (!std::isfinite(distance)) {
    return {.speed = v_max, .slope = 0.0};
  }
  // hyperbola below both lines, so that the slope is continuous where they meet; shifted through zero where the straight
  // one is, with its corner that much below v_max
  const double corner = 2.0 * v_max / (1.0 + kEnvelopeAtZero);
  const double rounding = kEnvelopeRounding * corner;
  const double approach = gain_[joint] * distance + receding;
  const double line = std::max(approach, -0.5 * v_max);
  const double difference = line - corner;
  const double root = std::sqrt(difference * difference + rounding * rounding);
  const double slope = approach > -0.5 * v_max ? gain_[joint] : 0.0;
  return {.speed = 0.5 * (line + corner * kEnvelopeAtZero - root),
          .slope = 0.5 * slope * (1.0 - difference / root)};
}

double JointLimits::allowed_speed(int joint, double distance) const {
  return envelope(joint, distance, 0.0).speed;
}

double JointLimits::allowed_acceleration(const Envelope& allowed, double receding, double speed,
                                         double slack) const {
  return -allowed.slope * (speed - receding) - options_.servo_gain * (speed - allowed.speed + slack);
}

void JointLimits::update_second_order(const VectorArg& q, const VectorArg& v, Part part) {
  const bool predicted = options_.measure == Measure::predicted;
  fill(
      q, part,
      [&](int j, double to_upper, double to_lower) {
        predicted ? fill_predicted_row(j, to_upper, to_lower, v[j])
                  : fill_position_row(j, to_upper, to_lower, v[j]);
      },
      [&](int j, double to_upper, double to_lower) {
        fill_acceleration_bounds(j, to_upper, to_lower, v[j]);
      });
  engagement_slack_ = options_.servo_gain * gain_.cwiseProduct(buffer_);
}

void JointLimits::fill_predicted_row(int j, double to_upper, double to_lower, double speed) {
  const double reserve = gain_[j] * buffer_[j];  // slack at which a row begins to act
  const Envelope upper = envelope(j, to_upper, upper_receding(j));
  const Envelope lower = envelope(j, to_lower, lower_receding(j));
  const double slack_upper = upper.speed - speed;
  const double slack_lower = lower.speed + speed;
  side_[j] = slack_upper <= slack_lower ? 1.0 : -1.0;
  activation_[j] = ramp(options_.ramp, 1.0 - std::min(slack_upper, slack_lower) / reserve);
  target_[j] = side_[j] > 0.0 ? allowed_acceleration(upper, upper_receding(j), speed, reserve)
                              : -allowed_acceleration(lower, lower_receding(j), -speed, reserve);
}

void JointLimits::fill_position_row(int j, double to_upper, double to_lower, double speed) {
  const double distance = std::min(to_upper, to_lower);
  side_[j] = to_upper <= to_lower ? 1.0 : -1.0;
  activation_[j] = ramp(options_.ramp, 1.0 - distance / buffer_[j]);
  const double servo = gain_[j] * options_.servo_gain;
  const double damping = gain_[j] + options_.servo_gain;
  const double relative = speed - (side_[j] > 0.0 ? upper_rate_[j] : lower_rate_[j]);
  target_[j] =
      std::isfinite(distance) ? side_[j] * servo * (distance - buffer_[j]) - damping * relative : 0.0;
}

void JointLimits::fill_acceleration_bounds(int j, double to_upper, double to_lower, double speed) {
  const double upper_away = upper_receding(j);
  const double lower_away = lower_receding(j);
  const Envelope ahead = envelope(j, to_upper - options_.margin, upper_away);
  const Envelope behind = envelope(j, to_lower - options_.margin, lower_away);
  motion_upper_[j] = allowed_acceleration(ahead, upper_away, speed, 0.0);
  motion_lower_[j] = -allowed_acceleration(behind, lower_away, -speed, 0.0);
  upper_at_rest_[j] = options_.servo_gain * std::max(0.0, ahead.speed);
  lower_at_rest_[j] = options_.servo_gain * std::max(0.0, behind.speed);
  note_near(j, gain_[j] * (to_upper - options_.margin) + upper_away,
            gain_[j] * (to_lower - options_.margin) + lower_away);
}

void JointLimits::headroom(const Vector& at_limit, const Vector& away, Vector& lower, Vector& upper) const {
  for (int j = 0; j < size(); ++j) {
    const double added = away[j] - at_limit[j];
    // as written it also takes an infinite bound; without anything to add the quotient may be zero by zero
    const auto with = [&](double bound) {
      return added > 0.0 ? at_limit[j] + added * (1.0 - 2.0 * added / (bound + 2.0 * added)) : at_limit[j];
    };
    lower[j] = with(lower_at_rest_[j]);
    upper[j] = with(upper_at_rest_[j]);
  }
}

void JointLimits::blended_acceleration_bounds(const Vector& activation, double dt, Vector& lower,
                                              Vector& upper) const {
  const double kappa = ramp_slope_factor(options_.ramp);
  for (int j = 0; j < size(); ++j) {
    const double gain = gain_[j];
    const double travel = buffer_[j] * (1.0 - 0.5 * gain * gain * dt * dt) / (kappa * dt);
    const double largest = std::max(0.0, (travel - velocity_limit_[j]) * gain / (1.0 + 0.5 * gain * dt));
    lower[j] = -largest;
    upper[j] = largest;
    Vector& near = side_[j] > 0.0 ? upper : lower;
    near[j] += activation[j] * (target_[j] - near[j]);
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

void JointLimits::engagement(const VectorArg& motion, Eigen::Ref<Vector> upper,
                             Eigen::Ref<Vector> lower) const {
  for (int j = 0; j < size(); ++j) {
    // a bound that only the speed limit sets is none of a position limit's
    const double scale = engagement_slack_[j];
    upper[j] = near_upper_[static_cast<std::size_t>(j)] != 0
                   ? ramp(options_.ramp, 1.0 - (motion_upper_[j] - motion[j]) / scale)
                   : 0.0;
    lower[j] = near_lower_[static_cast<std::size_t>(j)] != 0
                   ? ramp(options_.ramp, 1.0 - (motion[j] - motion_lower_[j]) / scale)
                   : 0.0;
  }
}

void JointLimits::activation_by_side(Eigen::Ref<Vector> upper, Eigen::Ref<Vector> lower) const {
  upper = (side_.array() > 0.0).select(activation_, 0.0);
  lower = (side_.array() < 0.0).select(activation_, 0.0);
}

}  // namespace tope
