#include "support/robots.hpp"

#include "support/text.hpp"

#include <algorithm>
#include <numbers>

namespace tope::test {

Robot youbot() {
  return Robot::from_urdf(source_path("robots/youbot/youbot.urdf"), source_path("robots/youbot/youbot.yaml"));
}

Robot youbot_before_obstacle() {
  Robot robot = youbot();
  Vector upper = robot.position_upper();
  upper[robot.joint_index("base_x")] = 0.35;
  robot.set_position_limits(robot.position_lower(), upper);
  return robot;
}

Vector random_position(Random& random, const Robot& robot, double margin) {
  Vector q(robot.nq());
  for (int j = 0; j < robot.nq(); ++j) {
    const double low = std::max(robot.position_lower()[j] + margin, -std::numbers::pi);
    const double high = std::min(robot.position_upper()[j] - margin, std::numbers::pi);
    q[j] = random.uniform(low, high);
  }
  return q;
}

}  // namespace tope::test
