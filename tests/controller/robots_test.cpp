// The same code on robots of three sources: closed loops to goals in reach, both modes, fixed, planar and floating bases.
// No limit is crossed, and the largest jump falls with the period. Not here: how often goals are reached, and how steep a
// command gets on far ones, through singularities; campaigns/robots_*.yaml measure that.
#include "support/robots.hpp"

#include "support/jump.hpp"
#include "support/loop.hpp"

#include <tope/robot/robot_terms.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_position.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <string>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(robots)
namespace {

struct Case {
  std::string name;
  Robot robot;
  std::string frame;
};

/// Joints whose drives, as described, cannot hold the arms in every pose, kept where they can.
Robot talos_that_holds_its_arms() {
  Robot robot = packaged_robot("talos");
  Vector lower = robot.position_lower();
  Vector upper = robot.position_upper();
  lower[robot.joint_index("torso_2_joint")] = -0.1;
  upper[robot.joint_index("torso_2_joint")] = 0.15;
  upper[robot.joint_index("arm_left_2_joint")] = 0.7;
  lower[robot.joint_index("arm_right_2_joint")] = -0.7;
  robot.set_position_limits(lower, upper);
  return robot;
}

std::vector<Case> cases(Mode mode) {
  std::vector<Case> all;
  for (const std::string& name : packaged_robots()) {
    const bool narrowed = name == "talos" && mode == Mode::torque;
    all.push_back({name, narrowed ? talos_that_holds_its_arms() : packaged_robot(name), hand_frame(name)});
  }
  RobotConfig rolling;
  rolling.locked_joints = {{"wheel_left_joint", 0.0}, {"wheel_right_joint", 0.0}};
  rolling.base = {.type = RobotConfig::MovingBase::Type::planar, .speed = 0.5, .turn_rate = 1.0};
  all.push_back(
      {"tiago on a planar base",
       Robot::from_urdf("package://example-robot-data/robots/tiago_description/robots/tiago_no_hand.urdf",
                        rolling),
       hand_frame("tiago")});
  RobotConfig flying;
  flying.base = {.type = RobotConfig::MovingBase::Type::floating, .speed = 0.5, .turn_rate = 1.0};
  all.push_back(
      {"ur5 on a floating base",
       Robot::from_urdf(
           "package://example-robot-data/robots/ur_description/urdf/ur5_joint_limited_robot.urdf", flying),
       hand_frame("ur5")});
  return all;
}

struct Outcome {
  double beyond;  // a limit
  double jump;    // share of the bound
};

Outcome drive(const Case& c, Mode mode, int seed, double dt) {
  Random random(static_cast<std::uint64_t>(seed));
  const Vector start = random_position(random, c.robot, 0.05);
  const Vector goal = start + 0.2 * (random_position(random, c.robot, 0.01) - start);
  RobotTerms there(c.robot);
  there.update(goal, Vector::Zero(c.robot.nv()));
  const int frame = c.robot.frame_index(c.frame);
  Loop loop(c.robot, {.mode = mode, .dt = dt}, start);
  loop.controller.add(1, FrameOrientation(c.robot, c.frame, there.frame_rotation(frame)));
  loop.controller.add(2, FramePosition(c.robot, c.frame, there.frame_position(frame)));
  loop.controller.add(3, Damping(c.robot));
  Jump jump(loop);
  double beyond = -1e9;
  loop.run(0.6, [&] {
    beyond = std::max(beyond, loop.beyond());
    jump();
  });
  return {.beyond = beyond, .jump = jump.largest};
}

}  // namespace

BOOST_AUTO_TEST_CASE(limits_are_kept_and_commands_are_continuous) {
  int runs = 0;
  int steep = 0;  // slopes that are shorter than a millisecond
  for (const Mode mode : {Mode::velocity, Mode::torque}) {
    for (const Case& c : cases(mode)) {
      for (int seed = 0; seed < 3; ++seed) {
        BOOST_TEST_CONTEXT(c.name << (mode == Mode::torque ? ", torque" : ", velocity") << ", seed "
                                  << seed) {
          const Outcome coarse = drive(c, mode, seed, 1e-3);
          const Outcome fine = drive(c, mode, seed, 1e-4);
          BOOST_TEST(coarse.beyond < 0.0);
          BOOST_TEST(fine.beyond < 0.0);
          BOOST_TEST_MESSAGE("jump " << coarse.jump << ", at a tenth of the period " << fine.jump);
          ++runs;
          steep += coarse.jump >= 8.0 * fine.jump ? 0 : 1;
        }
      }
    }
  }
  BOOST_TEST(runs == 42);
  BOOST_TEST(steep <= 2);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
