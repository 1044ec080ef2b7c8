#pragma once

#include <tope/common/types.hpp>
#include <tope/limit/ramp.hpp>
#include <tope/robot/robot.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tope {

/// What the activation of a limit row is measured on in torque mode.
enum class Measure {
  predicted,  ///< the position that the joint is braking to, with the speed bound in the same row: safe
  position,   ///< the position alone, as in the paper: does not protect the limit, kept for comparison
};

struct JointLimitOptions {
  double buffer = 0.1;                      ///< beta: width of the zone inside each limit [rad or m]
  std::map<std::string, double> buffers{};  ///< joints with a buffer of their own
  /// lambda, gamma_1: speed allowed or asked for per distance [1/s]. Unset: JointLimits::default_gain; a controller in
  /// torque mode takes less for a joint whose motor could not brake.
  std::optional<double> gain{};
  std::map<std::string, double> gains{};  ///< joints with a gain of their own [1/s]
  Ramp ramp = Ramp::raised_cosine;        ///< how activations rise across the buffer
  double servo_gain = 10.0;  ///< gamma_2: how fast speed returns below the envelope, torque mode [1/s]
  Measure measure = Measure::predicted;  ///< of the activations in torque mode
  double margin = 1e-3;                  ///< m: distance kept from the limit by the unilateral law [rad or m]
};

/// Where the limits of a joint are at one moment, and how fast they move: a limit may stand for something that does.
struct LimitMotion {
  double lower;             ///< [rad or m]
  double upper;             ///< [rad or m]
  double lower_rate = 0.0;  ///< [rad/s or m/s]
  double upper_rate = 0.0;  ///< [rad/s or m/s]
};

/// The limit rows of a robot's joints: one row a joint, whichever side is near.
///
/// Velocity mode, update().
/// With the buffer's inner edge q~ = upper - beta (or lower + beta), (20)-(21): activation xi rises from 0 at
/// q~ to 1 at the limit, (23)-(25), and the row asks for v = gain (q~ - q). As bounds for the unilateral law:
///   -min(v_max, gain (q - lower - m)) <= v <= min(v_max, gain (upper - m - q)),
/// which lead back where a joint is beyond its limit, at no more than half of v_max. A limit that moves adds its
/// velocity to both.
///
/// Torque mode, update_second_order(). The allowed speed towards the upper limit is the envelope
///   V(q) = smooth-min(gain (upper - q), v_max),
/// and the row, with slack s = V - v, has xi = ramp(1 - s / (gain beta)) and asks for the acceleration
///   V' v - servo_gain (v - V + gain beta),
/// which away from v_max is (19) with lambda_p = gain servo_gain, lambda_v = gain + servo_gain, measured on the
/// predicted position q + v / gain. As bounds for the unilateral law, with the margin taken off the limit:
///   dv/dt <= V' v - servo_gain (v - V),  and the mirror image below.
/// Towards a limit that moves, its velocity adds to gain (upper - q), and V' acts on the velocity relative to it.
class JointLimits {
 public:
  static constexpr double default_gain = 10.0;  ///< [1/s]

  /// Errors: ConfigError for an unknown joint in `buffers`, buffers that overlap or a value that is not
  /// positive.
  JointLimits(const Robot& robot, const JointLimitOptions& options);

  /// Moves the limits of a joint from the next update on. Never allocates. False, and nothing changes, for a joint that
  /// is none, a motion that is not finite where the joint has a limit, or buffers that would overlap.
  [[nodiscard]] bool move(int joint, const LimitMotion& motion);

  /// What an update works out; the rest is as it was.
  enum class Part {
    rows,    ///< activation(), target() and the bounds of blends
    bounds,  ///< motion_lower(), motion_upper(), headroom() and engagement()
    both,
  };
  /// Evaluates every joint at q (nq). Never allocates.
  void update(const VectorArg& q, Part part = Part::both);
  /// The same for torque mode, at q (nq) and v (nv): motions are accelerations.
  void update_second_order(const VectorArg& q, const VectorArg& v, Part part = Part::both);

  int size() const { return static_cast<int>(lower_.size()); }
  const Vector& activation() const { return activation_; }  ///< xi of each joint's row (n)
  const Vector& target() const { return target_; }          ///< motion the row asks for (n)
  const Vector& motion_lower() const { return motion_lower_; }
  const Vector& motion_upper() const { return motion_upper_; }
  /// What a law leaves free of each bound (n), so that its command turns gently where bounds and tasks meet: `at_limit`
  /// (n) at the limit, where the bound B of a joint at rest is zero, and more with B, up to `away` >= at_limit (n):
  ///   at_limit + (away - at_limit) B / (B + 2 (away - at_limit))
  /// At most half of B is added: a joint still comes to rest where `at_limit` alone would let it.
  void headroom(const Vector& at_limit, const Vector& away, Vector& lower, Vector& upper) const;
  /// Speed bounds (n) of a command that blends limit rows: v_max away from the limits and, across the buffer,
  /// (1 - xi) v_max + xi target towards the limit. What a blend adds from laws without the row must not exceed
  /// (1 - xi) v_max: bounded by v_max alone it can carry the joint through its limit. `activation` (n) is xi, zero
  /// for joints whose rows take no part.
  void blended_speed_bounds(const Vector& activation, Vector& lower, Vector& upper) const;
  /// Bounds (n) of an acceleration that blends limit rows: (1 - xi) A + xi target towards the limit, where A is the
  /// largest acceleration for which the buffer is wide enough at period dt [s].
  void blended_acceleration_bounds(const Vector& activation, double dt, Vector& lower, Vector& upper) const;
  /// Joint furthest beyond a limit, or -1.
  int beyond() const { return beyond_; }

  /// How far a motion (n) engages each bound of the unilateral law: ramp(1 - slack / (gain beta)), in torque mode
  /// ramp(1 - slack / (gain servo_gain beta)); 1 where it presses.
  void engagement(const VectorArg& motion, Eigen::Ref<Vector> upper, Eigen::Ref<Vector> lower) const;
  /// Activation by side: that of the row, on the side where the joint is.
  void activation_by_side(Eigen::Ref<Vector> upper, Eigen::Ref<Vector> lower) const;

  const Vector& lower() const { return lower_; }
  const Vector& upper() const { return upper_; }
  const Vector& velocity_limit() const { return velocity_limit_; }
  double buffer(int joint) const { return buffer_[joint]; }
  const Vector& gains() const { return gain_; }             ///< of each joint (n) [1/s]
  double gain(int joint) const { return gain_[joint]; }     ///< [1/s]
  double least_gain() const { return gain_.minCoeff(); }    ///< of all joints [1/s]
  double largest_gain() const { return gain_.maxCoeff(); }  ///< of all joints [1/s]
  const JointLimitOptions& options() const { return options_; }
  /// Torque mode: V of a joint at `distance` from a limit that rests [rad/s or m/s]; zero at the limit.
  double allowed_speed(int joint, double distance) const;
  /// True when the joint has a finite limit on either side.
  bool limited(int joint) const;

 private:
  /// Allowed speed towards a limit at `distance` that recedes, and its slope with respect to the distance.
  struct Envelope {
    double speed;
    double slope;
  };
  Envelope envelope(int joint, double distance, double receding) const;
  /// Acceleration allowed towards a limit at approach speed `speed`, `slack` below the envelope.
  double allowed_acceleration(const Envelope& allowed, double receding, double speed, double slack) const;
  /// How fast the limit on a side moves away from the joint.
  double upper_receding(int joint) const { return upper_rate_[joint]; }
  double lower_receding(int joint) const { return -lower_rate_[joint]; }
  double range_needed(int joint) const;
  template <typename FillRow, typename FillBounds>
  void fill(const VectorArg& q, Part part, FillRow row, FillBounds bounds);
  void fill_row(int j, double to_upper, double to_lower);
  void fill_bounds(int j, double to_upper, double to_lower);
  void fill_predicted_row(int j, double to_upper, double to_lower, double speed);
  void fill_position_row(int j, double to_upper, double to_lower, double speed);
  void fill_acceleration_bounds(int j, double to_upper, double to_lower, double speed);
  void note_near(int joint, double ahead, double behind);
  void note_beyond(int joint, double distance);

  JointLimitOptions options_;
  Vector gain_;
  Vector lower_;
  Vector upper_;
  Vector lower_rate_;
  Vector upper_rate_;
  Vector velocity_limit_;
  Vector buffer_;
  Vector activation_;
  Vector target_;
  Vector side_;  // +1 where the upper limit's row applies, -1 the lower's
  Vector motion_lower_;
  Vector motion_upper_;
  Vector lower_at_rest_;  // what the bounds are, or would be, at rest; not below zero
  Vector upper_at_rest_;
  std::vector<char> near_upper_;  // 1 where the position limit sets motion_upper_, not the speed limit
  std::vector<char> near_lower_;
  Vector engagement_slack_;  // at which engagement() begins
  int beyond_ = -1;
  double furthest_beyond_ = 0.0;  // how far that joint is beyond its limit
};

}  // namespace tope
