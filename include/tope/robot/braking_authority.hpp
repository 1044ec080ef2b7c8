#pragma once

#include <tope/common/types.hpp>
#include <tope/robot/robot.hpp>

namespace tope {

/// What the drives can give beyond gravity in the worst pose: for each joint the least
/// (effort - |gravity|) (H^-1)_jj over a fixed, low-discrepancy set of poses inside the position limits (nv)
/// [rad/s2 or m/s2]. That is the acceleration of one joint while the others, under torques that only compensate the
/// bias, give way. An estimate: speed-dependent forces and several joints that brake at once are not in it.
/// Errors: ConfigError where the mass matrix is not positive definite, naming the joint that moves no mass.
Vector braking_authority(const Robot& robot);

}  // namespace tope
