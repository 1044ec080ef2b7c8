// Pointing, the centre of mass and selected rows in closed loops of both modes: they arrive, follow what moves, leave free
// what they say is free, and never touch the heap. Not here: their derivatives (task_test, task_second_order_test).
#include "support/loop.hpp"
#include "support/no_allocation.hpp"
#include "support/robots.hpp"

#include <tope/task/center_of_mass.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/pointing.hpp>
#include <tope/task/selected_rows.hpp>

#include <boost/test/unit_test.hpp>

#include <string>

namespace tope::test {
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

double error_left_by_torques(const Task& task, double duration) {
  Loop loop(youbot(), {.mode = Mode::torque});
  loop.controller.add(2, Damping(loop.robot));
  return error_left(loop, task, duration);
}

}  // namespace

BOOST_AUTO_TEST_SUITE(reaching)

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
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
