#pragma once

#include <tope/controller/torque_bounds.hpp>
#include <tope/law/law.hpp>
#include <tope/limit/collision_limits.hpp>
#include <tope/limit/joint_limits.hpp>
#include <tope/limit/potential_field.hpp>

#include <optional>
#include <vector>

namespace tope {

/// What the command is.
enum class Mode {
  velocity,  ///< u = joint velocities [rad/s or m/s]
  torque,    ///< u = joint torques and forces [Nm or N]
};

/// What moves the joints that no task asks for, in torque mode.
enum class NullSpace {
  compensated,  ///< the bias h is always compensated
  zero_torque,  ///< nothing, as in the paper: the null space falls and drifts
};

/// Unilateral::Options; what is unset is chosen for the mode, since the units differ, and for the robot: damping and lock
/// of torque mode fall with the inertia of its heaviest joint, and headrooms are smaller for joints whose bounds leave
/// less room. docs/parameters.md shows how they were chosen.
struct UnilateralOptions {
  std::optional<double> damping{};
  std::optional<double> fine_damping{};
  std::optional<double> fine_below{};
  std::optional<double> lock{};
  std::optional<double> headroom{};
  /// Where a bound is wide; five times `headroom` unless set, in torque mode ten times.
  std::optional<double> free_headroom{};
  std::optional<double> inequality_headroom{};
  std::optional<double> softness{};
  std::optional<Smoothing> smoothing{};  ///< weaker kinks, at so many times the cost

  /// `heaviest` [kg or kg m2]: torque mode, heaviest_joint of the robot.
  Unilateral::Options resolved(Mode mode, double heaviest) const;
};

struct LimitOptions {
  LimitMethod method = LimitMethod::unilateral;
  JointLimitOptions rows{};                      ///< buffers, gain, ramp, margin
  UnilateralOptions unilateral{};                ///< used by the method of that name
  PotentialFieldOptions potential_field{};       ///< used by the method of that name
  std::optional<CollisionOptions> collisions{};  ///< distances to keep, by the method `unilateral` alone
  bool enforce_conditions = true;  ///< false: build the controller although a safety inequality fails
};

struct ControllerOptions {
  Mode mode = Mode::velocity;
  double dt = 1e-3;  ///< period of the loop [s]
  LimitOptions limits{};
  Hierarchy::Options singularities{};             ///< of every method but unilateral
  NullSpace null_space = NullSpace::compensated;  ///< torque mode
  /// Torque mode: tasks and dynamics where the robot will be in the middle of the coming period, given its velocity and
  /// the acceleration asked for last; false: at the measured state, where joints of little inertia drift with the period.
  bool midpoint = true;
  WheelDistribution wheel_distribution = WheelDistribution::minimum_norm;  ///< torque mode
  /// Velocity mode: cost of each joint's motion (nv), positive: the law minimises sum weight_j v_j^2 where tasks
  /// leave a choice. Empty: all ones.
  std::vector<double> joint_weights{};
};

}  // namespace tope
