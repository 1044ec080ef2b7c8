#pragma once

#include <Eigen/Core>

#include <array>

namespace tope {

/// How the torques of four wheels share the wrench of the base.
enum class WheelDistribution {
  minimum_norm,  ///< least sum of squares, (2) of the paper
  minimum_peak,  ///< least largest torque: up to half as much again before a wheel meets its bound
};

/// Geometry and drives of a base on four mecanum wheels.
struct MecanumBaseOptions {
  std::array<int, 3> joints{0, 1, 2};  ///< indices of the joints x [m], y [m] and yaw [rad]
  double wheel_radius = 0.0;           ///< r [m]
  double half_wheelbase = 0.0;         ///< l_x [m]
  double half_track = 0.0;             ///< l_y [m]
  double wheel_effort_limit = 0.0;     ///< torque bound of a wheel [Nm]
  double wheel_rotor_inertia = 0.0;    ///< rotor inertia of a wheel's drive, seen at the wheel [kg m2]
};

/// Maps between base motion and wheels, (2)-(3) of the paper. Wheels in the order front left, front right,
/// back left, back right; a positive speed rolls the robot forward.
class MecanumBase {
 public:
  using WheelMap = Eigen::Matrix<double, 4, 3>;
  using Wheels = Eigen::Vector4d;

  /// Errors: ConfigError when the radius or a half length is not positive.
  explicit MecanumBase(const MecanumBaseOptions& options);

  /// A (4 x 3) [1/m, 1]: wheel speeds = A (v_x, v_y, yaw rate), all in the base frame. Its transpose maps
  /// wheel torques to the base wrench.
  const WheelMap& wheel_map() const { return wheel_map_; }

  /// Wheel speeds [rad/s] for the joint velocities `v` (nv) of the whole robot at yaw angle `yaw` [rad].
  Wheels wheel_speeds(const Eigen::Ref<const Eigen::VectorXd>& v, double yaw) const;

  /// Motion along the base's axes (v_x, v_y [m/s], yaw rate [rad/s]) that fits the wheel speeds [rad/s] best: what
  /// odometry adds up.
  Eigen::Vector3d twist(const Wheels& speeds) const;
  /// (x, y) turned from the base's axes to the world's at yaw angle `yaw` [rad]; the turn stays.
  static Eigen::Vector3d to_world(const Eigen::Vector3d& motion, double yaw);

  /// Wheel torques [Nm] of least norm that give a base wrench (f_x, f_y [N], moment [Nm]) along the base's axes.
  Wheels minimum_norm_torques(const Eigen::Vector3d& wrench) const;
  /// Wheel torques of least peak for it: the least-norm ones, shifted along (1, 1, -1, -1), which moves nothing, until
  /// the largest torque either way is the same.
  Wheels minimum_peak_torques(const Eigen::Vector3d& wrench) const;
  /// One of the two.
  Wheels wheel_torques(const Eigen::Vector3d& wrench, WheelDistribution distribution) const;
  /// What a wheel torque of each drive gives at the base; inverse of both maps above.
  Eigen::Vector3d wrench(const Wheels& torques) const { return wheel_map_.transpose() * torques; }
  /// Base wrench along the base's axes of the joint forces `u` (nv) at yaw angle `yaw` [rad].
  Eigen::Vector3d base_wrench(const Eigen::Ref<const Eigen::VectorXd>& u, double yaw) const;

  /// What the wheels' rotors add to the inertia at the joints x, y [kg] and yaw [kg m2]: the diagonal of A^T
  /// J A.
  Eigen::Vector3d reflected_inertia() const;

  const MecanumBaseOptions& options() const { return options_; }

 private:
  Eigen::Vector3d to_base(double x, double y, double turn, double yaw) const;

  MecanumBaseOptions options_;
  WheelMap wheel_map_;
};

}  // namespace tope
