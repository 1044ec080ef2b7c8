#pragma once

#include <tope/common/types.hpp>
#include <tope/limit/ramp.hpp>
#include <tope/robot/robot.hpp>

#include <map>
#include <string>

namespace tope {

struct JointLimitOptions {
  double buffer = 0.1;                      ///< beta: width of the zone inside each limit [rad or m]
  std::map<std::string, double> buffers{};  ///< joints with a buffer of their own
  double gain = 10.0;                       ///< lambda: speed allowed or asked for per distance [1/s]
  Ramp ramp = Ramp::raised_cosine;          ///< how activations rise across the buffer
  double margin = 1e-3;  ///< m: distance kept from the limit by the unilateral law [rad or m]
};

/// The limit rows of a robot's joints in velocity mode: one row a joint, whichever side is near.
///
/// With the buffer's inner edge q~ = upper - beta (or lower + beta), (20)-(21): activation xi rises from 0 at
/// q~ to 1 at the limit, (23)-(25), and the row asks for v = gain (q~ - q). As bounds for the unilateral law:
///   -min(v_max, gain (q - lower - m)) <= v <= min(v_max, gain (upper - m - q)),
/// which lead back where a joint is beyond its limit, at no more than half of v_max.
class JointLimits {
 public:
  /// Errors: ConfigError for an unknown joint in `buffers`, buffers that overlap or a value that is not
  /// positive.
  JointLimits(const Robot& robot, const JointLimitOptions& options);

  /// Evaluates every row at q (nq). Never allocates.
  void update(const VectorArg& q);

  int size() const { return static_cast<int>(lower_.size()); }
  const Vector& activation() const { return activation_; }  ///< xi of each joint's row (n)
  const Vector& target() const { return target_; }          ///< motion the row asks for (n)
  const Vector& motion_lower() const { return motion_lower_; }
  const Vector& motion_upper() const { return motion_upper_; }
  /// Speed bounds (n) of a command that blends limit rows: v_max away from the limits and, across the buffer,
  /// (1 - xi) v_max + xi target towards the limit. What a blend adds from laws without the row must not exceed
  /// (1 - xi) v_max: bounded by v_max alone it can carry the joint through its limit. `activation` (n) is xi, zero
  /// for joints whose rows take no part.
  void blended_speed_bounds(const Vector& activation, Vector& lower, Vector& upper) const;
  /// Joint furthest beyond a limit, or -1.
  int beyond() const { return beyond_; }

  /// How far motion v (n) engages each bound of the unilateral law: ramp(1 - slack / (gain beta)), 1 where it
  /// presses.
  void engagement(const VectorArg& v, Eigen::Ref<Vector> upper, Eigen::Ref<Vector> lower) const;
  /// Activation by side: that of the row, on the side where the joint is.
  void activation_by_side(Eigen::Ref<Vector> upper, Eigen::Ref<Vector> lower) const;

  const Vector& lower() const { return lower_; }
  const Vector& upper() const { return upper_; }
  const Vector& velocity_limit() const { return velocity_limit_; }
  double buffer(int joint) const { return buffer_[joint]; }
  const JointLimitOptions& options() const { return options_; }
  /// True when the joint has a finite limit on either side.
  bool limited(int joint) const;

 private:
  JointLimitOptions options_;
  Vector lower_;
  Vector upper_;
  Vector velocity_limit_;
  Vector buffer_;
  Vector activation_;
  Vector target_;
  Vector side_;  // +1 where the upper limit's row applies, -1 the lower's
  Vector motion_lower_;
  Vector motion_upper_;
  int beyond_ = -1;
};

}  // namespace tope
