#pragma once

#include <tope/common/types.hpp>

namespace tope {

/// e = log R of a rotation R, its length, and the inverse right Jacobian J_r^-1(e): de/dt = J_r^-1 (R^T w).
struct RotationError {
  Vector3 vector;
  double angle;
  Matrix3 inverse_right_jacobian;
};
RotationError rotation_error(const Matrix3& rotation);

/// Rotation vector of a rotation matrix [rad], its length in [0, pi]. Accurate near zero and near pi.
Vector3 rotation_vector(const Matrix3& rotation);

/// Inverse of the right Jacobian of SO(3) at the rotation vector e: d/dt log(R) = J_r^-1(log R) w, with w the
/// angular velocity along the axes of the rotating frame (Sola et al., "A micro Lie theory", eq. 144).
Matrix3 inverse_right_jacobian(const Vector3& e);

/// Time derivative of inverse_right_jacobian(e) as e moves with rate `e_rate`.
Matrix3 inverse_right_jacobian_rate(const Vector3& e, const Vector3& e_rate);

}  // namespace tope
