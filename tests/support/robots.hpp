#pragma once

#include "support/random.hpp"

#include <tope/robot/robot.hpp>

namespace tope::test {

/// The KUKA youBot with its configuration: base_x, base_y, base_yaw, arm_joint_1 to 5.
Robot youbot();
/// The youBot with base_x stopped at 0.35 m, as an obstacle on the floor would.
Robot youbot_before_obstacle();

/// q within the limits, at least `margin` from each; joints without limits within +-pi.
Vector random_position(Random& random, const Robot& robot, double margin);

}  // namespace tope::test
