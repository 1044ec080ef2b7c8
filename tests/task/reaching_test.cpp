// Pointing, the centre of mass, relative poses, manipulability, selected rows and joint groups, waypoints and streams in closed
// loops of both modes: they arrive, follow what moves, leave free what they say is free, and never touch the heap. Not here: their derivatives (task_test, task_second_order_test).
#include "support/loop.hpp"
#include "support/no_allocation.hpp"
#include "support/robots.hpp"

#include <tope/reference/target_stream.hpp>
#include <tope/reference/waypoints.hpp>
#include <tope/task/center_of_mass.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_pose.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_group.hpp>
#include <tope/task/joint_position.hpp>
#include <tope/task/manipulability.hpp>
#include <tope/task/pointing.hpp>
#include <tope/task/relative_pose.hpp>
#include <tope/task/selected_rows.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(reaching)
namespace {

/// Norm of the error that `task` has left at level 1 after `duration`.
double error_left(Loop& loop, const Task& task, double duration) {
  const TaskHandle handle = loop.controller.add(1, task);
  while (loop.t < duration) {
    {
      const NoAllocation guard(std::string(task.type()));
      loop.command();
    }
    loop.follow();
  }
  return loop.controller.task(handle).error().norm();
}

const std::vector<std::string> kArm{"arm_joint_1", "arm_joint_2", "arm_joint_3", "arm_joint_4",
                                    "arm_joint_5"};

/// A law without damping, for figures that its task's definition tells exactly.
const ControllerOptions kExact{.limits = {.method = LimitMethod::chain}};

/// Where the end-effector of a loop is.
Vector3 end_effector(const Loop& loop) {
  RobotTerms terms(loop.robot);
  terms.update(loop.q, loop.v);
  return terms.frame_position(loop.robot.frame_index("ee"));
}

/// A relative target near where a loop begins, for the end-effector as the base sees it.
RelativeTarget near_start(const Loop& loop, const Vector3& shift, const Vector3& turn) {
  RobotTerms terms(loop.robot);
  terms.update(loop.q, loop.v);  // base and world coincide, but for a height
  const int ee = loop.robot.frame_index("ee");
  const Vector3 base = terms.frame_position(loop.robot.frame_index("base_link"));
  return {.position = moving_along_sine(terms.frame_position(ee) - base, shift, 0.1),
          .rotation = spinning(terms.frame_rotation(ee), turn)};
}

double error_left_by_torques(const Task& task, double duration) {
  Loop loop(youbot(), {.mode = Mode::torque});
  loop.controller.add(2, Damping(loop.robot));
  return error_left(loop, task, duration);
}

}  // namespace

BOOST_AUTO_TEST_CASE(camera_looks_at_a_point) {
  Loop loop(youbot(), {});
  BOOST_TEST(error_left(loop, Pointing(loop.robot, "ee", Vector3::UnitZ(), Vector3(1.0, 0.5, 0.3)), 6.0) <
             1e-4);
  RobotTerms terms(loop.robot);
  terms.update(loop.q, loop.u);
  const int ee = loop.robot.frame_index("ee");
  const Vector3 sight = (Vector3(1.0, 0.5, 0.3) - terms.frame_position(ee)).normalized();
  BOOST_TEST((terms.frame_rotation(ee).col(2) - sight).norm() < 2e-4);
}

BOOST_AUTO_TEST_CASE(camera_follows_a_point) {
  Loop loop(youbot(), {});
  const Pointing follow(loop.robot, "ee", Vector3::UnitZ(),
                        moving_along_sine(Vector3(1.0, 0.5, 0.3), Vector3(0.1, 0.2, 0.1), 0.2));
  BOOST_TEST(error_left(loop, follow, 6.0) < 1e-3);
}

BOOST_AUTO_TEST_CASE(centre_of_mass_arrives) {
  Loop loop(youbot(), {});
  RobotTerms terms(loop.robot);
  terms.update(loop.q, loop.u);
  const Vector3 target = terms.com_position() + Vector3(0.1, -0.05, 0.005);
  BOOST_TEST(error_left(loop, CenterOfMass(loop.robot, target), 6.0) < 1e-4);
}

BOOST_AUTO_TEST_CASE(height_alone_is_kept) {
  Loop loop(youbot(), {});
  const FramePosition position(loop.robot, "ee", Vector3(50.0, 50.0, 0.3));
  BOOST_TEST(error_left(loop, SelectedRows(position, {2}), 6.0) < 1e-4);
  BOOST_TEST(loop.q.head(3).norm() < 1e-12);  // the base does nothing for the height
}

BOOST_AUTO_TEST_CASE(frame_is_kept_still_in_a_base_that_moves) {
  Loop loop(youbot(), {});
  const FramePosition base(loop.robot, "base_link",
                           moving_along_sine(Vector3::Zero(), Vector3(0.3, 0.2, 0.0), 0.2));
  loop.controller.add(1, SelectedRows(base, {0, 1}));
  loop.controller.add(3, Damping(loop.robot));
  const RelativeTarget start = near_start(loop, Vector3::Zero(), Vector3::Zero());
  const Vector3 target = start.position->at(0.0).position + Vector3(0.03, -0.02, 0.04);
  const TaskHandle hold =
      loop.controller.add(2, RelativePose(loop.robot, "ee", "base_link", {.position = PointTarget{target}}));
  loop.run(5.0);
  BOOST_TEST(loop.controller.task(hold).error().norm() < 1e-4);
  RobotTerms terms(loop.robot);
  terms.update(loop.q, loop.v);
  const int base_link = loop.robot.frame_index("base_link");
  const Vector3 offset = end_effector(loop) - terms.frame_position(base_link);
  BOOST_TEST((terms.frame_rotation(base_link).transpose() * offset - target).norm() < 1e-3);
}

BOOST_AUTO_TEST_CASE(relative_pose_follows_its_target) {
  Loop loop(youbot(), {});
  RelativeTarget target = near_start(loop, Vector3(0.0, 0.0, 0.03), Vector3(0.0, 0.0, 0.1));
  target.rotation.reset();
  BOOST_TEST(error_left(loop, RelativePose(loop.robot, "ee", "base_link", target), 4.0) < 1e-4);
}

BOOST_AUTO_TEST_CASE(relative_rotation_follows_its_target_in_both_modes) {
  for (const Mode mode : {Mode::velocity, Mode::torque}) {
    Loop loop(youbot(), {.mode = mode});
    RelativeTarget target = near_start(loop, Vector3::Zero(), Vector3(0.02, 0.03, 0.1));
    target.position.reset();
    loop.controller.add(2, Damping(loop.robot));
    BOOST_TEST(error_left(loop, RelativePose(loop.robot, "ee", "base_link", target, Exponential(4.0)), 4.0) <
               1e-4);
  }
}

BOOST_AUTO_TEST_CASE(waypoints_are_passed_in_both_modes) {
  for (const Mode mode : {Mode::velocity, Mode::torque}) {
    Loop loop(youbot(), {.mode = mode, .limits = kExact.limits});
    RobotTerms terms(loop.robot);
    terms.update(loop.q, loop.v);
    const Matrix3 rotation = terms.frame_rotation(loop.robot.frame_index("ee"));
    const Vector3 start = end_effector(loop);
    const Vector3 middle = start + Vector3(0.1, 0.05, -0.03);
    const std::vector<PointWaypoint> points{
        {0.5, start}, {1.5, middle}, {3.0, start + Vector3(0.0, 0.1, 0.05)}};
    const std::vector<RotationWaypoint> rotations{
        {0.5, rotation}, {3.0, Eigen::AngleAxisd(0.5, Vector3::UnitZ()).toRotationMatrix() * rotation}};
    const TaskHandle pose = loop.controller.add(
        1, FramePose(loop.robot, "ee", through(points), through(rotations), Exponential(6.0)));
    loop.controller.add(2, Damping(loop.robot));
    double farthest = 0.0;
    double missed = INFINITY;
    loop.run(3.5, [&] {
      farthest = std::max(farthest, loop.controller.task(pose).error().norm());
      missed = std::min(missed, (end_effector(loop) - middle).norm() + std::abs(loop.t - 1.5));
    });
    BOOST_TEST(farthest < 1e-3);  // starts on its way, and never leaves it
    BOOST_TEST(missed < 2e-3);    // a millimetre, and a cycle
    BOOST_TEST(loop.controller.task(pose).error().norm() < 1e-5);
  }
}

BOOST_AUTO_TEST_CASE(joints_outside_a_group_do_not_move_for_it) {
  Loop loop(youbot(), {});
  const Vector3 target = end_effector(loop) + Vector3(0.02, 0.03, -0.02);
  BOOST_TEST(error_left(loop, JointGroup(loop.robot, FramePosition(loop.robot, "ee", target), kArm), 6.0) <
             1e-4);
  BOOST_TEST(loop.q.head(3).norm() == 0.0);
}

BOOST_AUTO_TEST_CASE(motion_outside_a_group_leaves_its_speed_over_the_gain) {
  constexpr double speed = 0.02;  // m/s
  constexpr double gain = 4.0;    // 1/s
  Loop loop(youbot(), kExact);
  const Vector3 target = end_effector(loop);
  const FramePosition drive(loop.robot, "base_link",
                            moving_along_line(Vector3::Zero(), Vector3(speed, 0.0, 0.0)));
  loop.controller.add(1, JointGroup(loop.robot, SelectedRows(drive, {0, 1}), {"base_x", "base_y"}));
  const TaskHandle hold = loop.controller.add(
      2, JointGroup(loop.robot, FramePosition(loop.robot, "ee", target, Exponential(gain)), kArm));
  loop.run(4.0);
  BOOST_TEST((loop.controller.task(hold).error() - Vector3(speed / gain, 0.0, 0.0)).norm() < 5e-5);
}

BOOST_AUTO_TEST_CASE(constant_velocity_outside_a_group_does_not_disturb_its_torques) {
  Loop loop(youbot(), {.mode = Mode::torque});
  const Vector3 target = end_effector(loop);
  const FramePosition drive(loop.robot, "base_link",
                            moving_along_line(Vector3::Zero(), Vector3(0.02, 0.0, 0.0)), Exponential(4.0));
  loop.controller.add(1, JointGroup(loop.robot, SelectedRows(drive, {0, 1}), {"base_x", "base_y"}));
  const TaskHandle hold = loop.controller.add(
      2, JointGroup(loop.robot, FramePosition(loop.robot, "ee", target, Exponential(4.0)), kArm));
  loop.controller.add(3, Damping(loop.robot));
  loop.run(5.0);
  BOOST_TEST(loop.v[0] > 0.019);
  BOOST_TEST(loop.controller.task(hold).error().norm() < 2e-4);  // 5 mm in velocity mode
}

BOOST_AUTO_TEST_CASE(lower_levels_cannot_disturb_a_group_through_its_joints) {
  Loop loop(youbot(), kExact);
  const Vector3 target = end_effector(loop) + Vector3(0.02, 0.03, -0.02);
  const TaskHandle reach =
      loop.controller.add(1, JointGroup(loop.robot, FramePosition(loop.robot, "ee", target), kArm));
  loop.controller.add(2, JointPosition(loop.robot, {{"arm_joint_3", 0.2}, {"arm_joint_1", 0.5}}));
  loop.command();
  const double before = loop.controller.task(reach).error().norm();
  loop.follow();
  loop.run(1.0);
  const double expected = before * std::exp(-2.0 * 1.0);
  BOOST_TEST(std::abs(loop.controller.task(reach).error().norm() - expected) < 2e-3 * before);
  BOOST_TEST(std::abs(loop.u[5]) > 1e-3);  // the lower level has some freedom left, and uses it
}

BOOST_AUTO_TEST_CASE(torques_of_a_group_are_those_of_its_joints) {
  Loop loop(youbot(), {.mode = Mode::torque, .midpoint = false});  // the bias is the measured state's
  RobotTerms terms(loop.robot);
  const Vector3 target = end_effector(loop) + Vector3(0.02, 0.03, -0.02);
  loop.controller.add(1, JointGroup(loop.robot, FramePosition(loop.robot, "ee", target), kArm));
  double largest = 0.0;
  while (loop.t < 1.0) {
    loop.command();
    terms.update_dynamics(loop.q, loop.v);
    largest = std::max(largest, (loop.u - terms.bias()).head(3).lpNorm<Eigen::Infinity>());
    loop.follow();
  }
  BOOST_TEST(largest < 1e-10);               // N, Nm
  BOOST_TEST(loop.q.head(3).norm() > 1e-4);  // the arm's reaction carries the base along
}

BOOST_AUTO_TEST_CASE(lower_level_holds_what_is_outside_a_group_still) {
  Loop loop(youbot(), {.mode = Mode::torque});
  const Vector3 target = end_effector(loop) + Vector3(0.02, 0.03, -0.02);
  const TaskHandle reach = loop.controller.add(
      1, JointGroup(loop.robot, FramePosition(loop.robot, "ee", target, Exponential(3.0)), kArm));
  loop.controller.add(2, Damping(loop.robot));
  loop.run(5.0);
  BOOST_TEST(loop.controller.task(reach).error().norm() < 1e-4);
  BOOST_TEST(loop.q.head(3).norm() < 1e-4);
}

/// The hand stays while the arm's manipulability of position is raised to a target, from a stretched arm.
struct RaisingLoop : Loop {
  RaisingLoop(Mode mode, double target) : Loop(youbot(), {.mode = mode}) {
    q << 0.0, 0.0, 0.0, 0.0, 0.4, 0.3, 0.2, 0.0;
    if (body) {
      body->reset(q);
    }
    const Exponential reference(3.0);
    hand = controller.add(1, FramePosition(robot, "ee", end_effector(*this), reference));
    raise = controller.add(
        2, Manipulability(robot, "ee", target, {.rows = {0, 1, 2}, .joints = kArm}, reference));
    controller.add(3, Damping(robot));
    command();
    slope_at_start = slope();
    while (t < 5.0) {
      {
        const NoAllocation guard("manipulability");
        command();
      }
      follow();
    }
  }

  double measure() const { return dynamic_cast<const Manipulability&>(controller.task(raise)).measure(); }

  /// Length of w's gradient along what leaves the hand in place.
  double slope() const {
    const Matrix& jacobian = controller.task(hand).jacobian();
    const Vector gradient = controller.task(raise).jacobian().row(0);
    return (gradient -
            jacobian.transpose() * (jacobian * jacobian.transpose()).llt().solve(jacobian * gradient))
        .norm();
  }

  TaskHandle hand;
  TaskHandle raise;
  double slope_at_start = 0.0;
};

BOOST_AUTO_TEST_CASE(manipulability_rises_while_the_hand_stays) {
  for (const Mode mode : {Mode::velocity, Mode::torque}) {
    const RaisingLoop loop(mode, 0.016);  // from 0.011
    BOOST_TEST(std::abs(loop.measure() - 0.016) < 1e-5);
    BOOST_TEST(loop.controller.task(loop.hand).error().norm() < 1e-5);
    BOOST_TEST(loop.v.norm() < 1e-3);
  }
}

BOOST_AUTO_TEST_CASE(manipulability_out_of_reach_climbs_to_the_top) {
  for (const Mode mode : {Mode::velocity, Mode::torque}) {
    const RaisingLoop loop(mode, 0.03);
    BOOST_TEST(loop.measure() > 0.0175);
    BOOST_TEST(loop.slope() < 0.1 * loop.slope_at_start);
    BOOST_TEST(loop.v.norm() < 2e-2);
    BOOST_TEST(loop.controller.task(loop.hand).error().norm() < 1e-5);
  }
}

BOOST_AUTO_TEST_CASE(samples_of_a_circle_are_followed_within_the_stated_lag) {
  for (const Mode mode : {Mode::velocity, Mode::torque}) {
    Loop loop(youbot(), {.mode = mode});
    const Vector3 start = end_effector(loop);
    const auto circle = moving_along_sine(start, Vector3(0.0, 0.05, 0.02), 0.2);
    PointStream stream(start);
    const Exponential reference(8.0);
    loop.controller.add(1, FramePosition(loop.robot, "ee", stream.target(), reference));
    loop.controller.add(2, Damping(loop.robot));
    double farthest = 0.0;
    double next = 0.0;
    while (loop.t < 6.0) {
      const PointTarget now = circle.at(loop.t);
      if (loop.t >= next) {  // a camera at 30 Hz
        BOOST_TEST(stream.put({.time = loop.t, .position = now.position, .velocity = now.velocity}));
        next += 1.0 / 30.0;
      }
      {
        const NoAllocation guard("stream");
        loop.command();
      }
      if (loop.t > 2.0) {
        farthest = std::max(farthest, (end_effector(loop) - now.position).norm());
      }
      loop.follow();
    }
    const double acceleration = circle.at(1.25).acceleration.norm();
    BOOST_TEST(farthest < 3.0 * acceleration / (20.0 * 20.0) + 3e-4);
    BOOST_TEST(farthest > 1e-5);
  }
}

BOOST_AUTO_TEST_CASE(torques_reach_all_of_them) {
  const Robot robot = youbot();
  RobotTerms terms(robot);
  terms.update(Loop(robot, {}).q, Vector::Zero(8));
  const Exponential reference(3.0);
  BOOST_TEST(error_left_by_torques(Pointing(robot, "ee", Vector3::UnitZ(), Vector3(1.0, 0.5, 0.3), reference),
                                   5.0) < 1e-2);
  BOOST_TEST(error_left_by_torques(
                 CenterOfMass(robot, Vector3(terms.com_position() + Vector3(0.05, -0.02, 0.003)), reference),
                 5.0) < 1e-2);
  const FramePosition position(robot, "ee", Vector3(50.0, 50.0, 0.3), reference);
  BOOST_TEST(error_left_by_torques(SelectedRows(position, {2}), 5.0) < 1e-2);
  RelativeTarget seen = near_start(Loop(robot, {}), Vector3(0.0, 0.0, 0.03), Vector3::Zero());
  seen.rotation.reset();
  BOOST_TEST(error_left_by_torques(RelativePose(robot, "ee", "base_link", seen, reference), 5.0) < 1e-3);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
