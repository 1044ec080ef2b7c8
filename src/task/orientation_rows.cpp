#include "orientation_rows.hpp"

#include "near_flip.hpp"

#include <tope/task/rotation_error.hpp>

#include <Eigen/Geometry>

#include <numbers>

namespace tope {

bool fill_orientation_rows(const Matrix3& rotation, const Eigen::Ref<const Matrix>& angular_jacobian,
                           const RotationTarget& target, Eigen::Ref<Vector> error,
                           Eigen::Ref<Matrix> jacobian, Eigen::Ref<Vector> feedforward) {
  const RotationError e = rotation_error(target.rotation.transpose() * rotation);
  // d/dt log(R_d^T R) = J_r^-1 R^T (w - w_d), all angular velocities along the world's axes
  const Matrix3 world_to_error = e.inverse_right_jacobian * rotation.transpose();
  error.head<3>() = e.vector;
  for (Eigen::Index j = 0; j < jacobian.cols(); ++j) {
    jacobian.col(j).head<3>() = world_to_error * angular_jacobian.col(j).head<3>();
  }
  feedforward.head<3>() = world_to_error * target.angular_velocity;
  return e.angle > std::numbers::pi - kNearFlip;
}

Vector3 orientation_drift(const RotationTarget& frame, const RotationTarget& target, const Vector3& error,
                          const Vector3& error_rate) {
  // e' = J_r^-1(e) w with w = R^T (w_frame - w_target); differentiate both factors
  const Matrix3 world_to_frame = frame.rotation.transpose();
  const Vector3 relative = world_to_frame * (frame.angular_velocity - target.angular_velocity);
  const Vector3 relative_rate = world_to_frame * (frame.angular_acceleration - target.angular_acceleration) -
                                (world_to_frame * frame.angular_velocity).cross(relative);
  return inverse_right_jacobian_rate(error, error_rate) * relative +
         inverse_right_jacobian(error) * relative_rate;
}

}  // namespace tope
