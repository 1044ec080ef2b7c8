#pragma once

#include <tope/common/types.hpp>
#include <tope/robot/robot.hpp>

namespace tope {

/// How many poses stand for all where a worst one is looked for.
inline constexpr int sampled_poses = 1000;

/// Pose k (nq) of a sequence that fills the robot's position limits evenly; a turn where a joint has none [rad or m].
Vector sampled_pose(const Robot& robot, int k);

}  // namespace tope
