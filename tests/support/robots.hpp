#pragma once

#include "support/random.hpp"

#include <tope/robot/robot.hpp>

#include <string>
#include <vector>

namespace tope::test {

/// The KUKA youBot with its configuration: base_x, base_y, base_yaw, arm_joint_1 to 5.
Robot youbot();
/// The youBot with base_x stopped at 0.35 m, as an obstacle on the floor would.
Robot youbot_before_obstacle();

/// A robot of a package, with its configuration in robots/: "panda", "ur5", "tiago", "talos" (upper body) or "kinova".
Robot packaged_robot(const std::string& name);
/// The frame of its hand, left hand or gripper.
std::string hand_frame(const std::string& name);
/// The names of all of them.
const std::vector<std::string>& packaged_robots();

/// q within the limits, at least `margin` from each; joints without limits within +-pi.
Vector random_position(Random& random, const Robot& robot, double margin);

}  // namespace tope::test
