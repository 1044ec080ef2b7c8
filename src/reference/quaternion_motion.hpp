#pragma once

#include "path_motion.hpp"

#include <tope/reference/target.hpp>

namespace tope {

/// Quaternion (w, x, y, z) of a rotation, of the two the one nearer to `near`.
Eigen::Vector4d quaternion_near(const Matrix3& rotation, const Eigen::Vector4d& near);

/// The rotation of a path of quaternions (w, x, y, z) of any length but zero, normalised, with its exact angular velocity
/// and acceleration. Paths there need no chart of the rotations and treat all axes alike.
RotationTarget rotation_on(const PathMotion<4>& motion);

}  // namespace tope
