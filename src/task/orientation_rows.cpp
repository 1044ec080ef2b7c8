#include "orientation_rows.hpp"

#include <tope/task/rotation_error.hpp>

#include <numbers>

namespace tope {

bool fill_orientation_rows(const Matrix3& rotation, const Eigen::Ref<const Matrix>& angular_jacobian,
                           const RotationTarget& target, Eigen::Ref<Vector> error,
                           Eigen::Ref<Matrix> jacobian, Eigen::Ref<Vector> feedforward) {
  const Vector3 e = rotation_vector(target.rotation.transpose() * rotation);
  // d/dt log(R_d^T R) = J_r^-1 R^T (w - w_d), all angular velocities along the world's axes
  const Matrix3 world_to_error = inverse_right_jacobian(e) * rotation.transpose();
  error = e;
  jacobian.noalias() = world_to_error * angular_jacobian;
  feedforward.noalias() = world_to_error * target.angular_velocity;
  return e.norm() > std::numbers::pi - 0.05;
}

}  // namespace tope
