// Controller::update never touches the heap: every method, limits active, singular poses, tasks coming and
// going, moving targets, bad input, and states beyond a limit. Not here: add() and remove(), which may
// allocate; models larger than eight joints (law room: up to 40).
#include "support/loop.hpp"
#include "support/no_allocation.hpp"
#include "support/robots.hpp"

#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_pose.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_position.hpp>
#include <tope/task/posture.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <string>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(controller_no_allocation)
namespace {

void guarded_steps(Loop& loop, int cycles, const std::string& what) {
  const NoAllocation guard(what);
  for (int i = 0; i < cycles; ++i) {
    loop.step();
  }
}

/// Calls `check` with a fresh loop for every method.
template <typename Check>
void for_every_method(Check check) {
  for (const std::string& name : limit_method_names()) {
    BOOST_TEST_CONTEXT(name) {
      Loop loop(youbot_before_obstacle(), {.limits = {.method = limit_method_from(name)}});
      check(loop);
      BOOST_TEST(loop.u.allFinite());
    }
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(while_tasks_come_and_go) {
  for_every_method([](Loop& loop) {
    const Robot& robot = loop.robot;
    Controller& controller = loop.controller;
    guarded_steps(loop, 2, "no task");
    const TaskHandle turn =
        controller.add(2, FrameOrientation(robot, "ee", Matrix3::Identity(), PredefinedTime(1.0)));
    controller.add(3, FramePosition(robot, "ee", Vector3(0.5, 0.1, 0.1)), {.over = 0.05});
    controller.add(4, Posture(robot, Vector::Zero(8)), {.over = 0.08});
    guarded_steps(loop, 30, "insertion");
    controller.move(turn, 3, {.over = 0.02});
    controller.replace(turn, FrameOrientation(robot, "ee", Matrix3::Identity()), {.over = 0.03});
    guarded_steps(loop, 30, "changes");
    controller.remove(turn, {.over = 0.03});
    controller.add(1, JointPosition(robot, {{"arm_joint_5", 3.0}, {"base_x", 1.0}}), {.over = 0.04});
    guarded_steps(loop, 30, "removal");
    controller.add(5, Damping(robot));
    guarded_steps(loop, 40, "after it");
  });
}

BOOST_AUTO_TEST_CASE(with_limits_active) {
  for_every_method([](Loop& loop) {
    const Robot& robot = loop.robot;
    loop.controller.add(1, FrameOrientation(robot, "ee", Matrix3::Identity()));
    loop.controller.add(2, FramePosition(robot, "ee", Vector3(2.0, 0.1, 0.1)));
    for (const int joint : {0, 4, 5, 7}) {
      loop.q[joint] = robot.position_upper()[joint] - 0.01 * (joint + 1);
    }
    guarded_steps(loop, 1, "limits");
    BOOST_TEST((loop.controller.options().limits.method == LimitMethod::none ||
                loop.controller.status().has(Event::limit)));
    guarded_steps(loop, 50, "limits");
    loop.q[3] = robot.position_lower()[3] - 0.1;
    loop.q[6] = robot.position_upper()[6] + 0.1;
    guarded_steps(loop, 20, "beyond");
    BOOST_TEST(loop.controller.status().has(Event::beyond));
  });
}

BOOST_AUTO_TEST_CASE(at_singular_poses) {
  for_every_method([](Loop& loop) {
    const Robot& robot = loop.robot;
    loop.controller.add(1, FramePosition(robot, "ee", Vector3(0.5, 0.1, 0.1)));
    loop.controller.add(2,
                        FramePose(robot, "ee", Vector3(0.4, 0.1, 0.2), Matrix3::Identity()));  // partly taken
    loop.controller.add(2, FramePosition(robot, "ee", Vector3(0.4, 0.1, 0.2)));  // twice in a level
    loop.controller.add(3, Posture(robot, Vector::Zero(8)));  // more rows than freedom left
    loop.controller.add(3, Damping(robot));                   // 16 rows for 8 joints
    loop.controller.add(4, Posture(robot, Vector::Zero(8)));
    loop.q.setZero();  // the arm stretched
    guarded_steps(loop, 30, "singular");
  });
}

BOOST_AUTO_TEST_CASE(with_moving_targets) {
  for_every_method([](Loop& loop) {
    const Vector3 centre(0.5, 0.1, 0.2);
    loop.controller.add(1, FramePose(loop.robot, "ee", moving_along_sine(centre, Vector3::Constant(0.1), 0.5),
                                     spinning(Matrix3::Identity(), Vector3(0.1, 0.2, 0.3))));
    loop.controller.add(2,
                        FramePosition(loop.robot, "arm_link_3", moving_along_line(centre, Vector3::UnitX())));
    guarded_steps(loop, 30, "moving targets");
  });
}

BOOST_AUTO_TEST_CASE(on_bad_input) {
  for_every_method([](Loop& loop) {
    loop.controller.add(1, FramePosition(loop.robot, "ee", Vector3(0.5, 0.1, 0.1)));
    const Vector bad = Vector::Constant(8, NAN);
    const Vector small = Vector::Zero(3);
    {
      const NoAllocation guard("bad input");
      loop.controller.update(bad, loop.u, 0.0, loop.u);
      loop.controller.update(small, loop.u, 0.0, loop.u);
      loop.controller.update(loop.q, loop.u, NAN, loop.u);
    }
    BOOST_TEST(loop.controller.status().has(Event::bad_input));
  });
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
