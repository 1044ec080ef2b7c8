#pragma once

#include <tope/common/types.hpp>
#include <tope/law/cholesky.hpp>
#include <tope/law/command_bounds.hpp>
#include <tope/robot/robot.hpp>

#include <vector>

namespace tope {

/// The bounds of torque mode: of each joint's torque, of each wheel's torque, and of the acceleration that limit rows
/// leave. Keeps all of them by one scale of the tasks' share.
class TorqueBounds {
 public:
  TorqueBounds(const Robot& robot, WheelDistribution distribution);

  /// Bounds (n) of the acceleration for the next apply().
  Vector& acceleration_lower() { return acceleration_lower_; }
  Vector& acceleration_upper() { return acceleration_upper_; }

  /// What the limits (and the bias) ask for, `first_*`, and the whole command, as accelerations and as torques
  /// (n each), at yaw angle `yaw` of the base [rad]. Scales `acceleration` and `torque`; clips `first_torque` where
  /// it is beyond a bound by itself: the joints that are not clipped then accelerate as they were asked to, whatever the others
  /// fail to do, by the mass matrix (n x n). The result names joints; a wheel's bound counts for the base's x.
  CommandBounds apply(const Matrix& mass_matrix, double yaw, const Vector& first_acceleration,
                      Vector& first_torque, Vector& acceleration, Vector& torque);

 private:
  void clip(double yaw, Vector& torque);
  void keep_the_others(const Matrix& mass_matrix, const Vector& asked, Vector& torque);
  void fill(const Vector& acceleration, const Vector& torque, double yaw, Vector& rows) const;
  int joint_of(int row) const;

  Robot robot_;
  Matrix wheel_rows_;  // of the base wrench (k x 3), within +-wheel_bound_
  double wheel_bound_ = 0.0;
  Vector wheels_;  // (k)
  Vector acceleration_lower_;
  Vector acceleration_upper_;
  Vector lower_;  // accelerations, torques, wheel rows (2 n + k)
  Vector upper_;
  Vector first_;
  Vector command_;
  Vector asked_;               // torques before they are clipped (n)
  std::vector<int> short_of_;  // joints that are clipped
  PanelMatrix block_;          // their part of the mass matrix
  Cholesky factor_;
  Vector missed_;  // by so much they accelerate less
};

}  // namespace tope
