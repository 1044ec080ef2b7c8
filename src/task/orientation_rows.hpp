#pragma once

#include <tope/common/types.hpp>
#include <tope/reference/target.hpp>

namespace tope {

/// Error, Jacobian and feedforward (3 rows) of e = log(R_d^T R), for a frame turned by `rotation` whose
/// angular velocity along the world's axes is `angular_jacobian` (3 x nv) times v. True within 0.05 rad of
/// the flip at pi.
bool fill_orientation_rows(const Matrix3& rotation, const Eigen::Ref<const Matrix>& angular_jacobian,
                           const RotationTarget& target, Eigen::Ref<Vector> error,
                           Eigen::Ref<Matrix> jacobian, Eigen::Ref<Vector> feedforward);

/// d2e/dt2 of e = log(R_d^T R) for a frame that moves as `frame` says (world axes), no joint accelerating.
Vector3 orientation_drift(const RotationTarget& frame, const RotationTarget& target, const Vector3& error,
                          const Vector3& error_rate);

}  // namespace tope
