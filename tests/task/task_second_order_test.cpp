// Error rate and drift of every task against central differences along joint motions with constant acceleration, with
// fixed and moving targets: d2e/dt2 = J a + drift. Not here: the first order (task_test).
#include "support/no_allocation.hpp"
#include "support/robots.hpp"

#include <tope/reference/waypoints.hpp>
#include <tope/task/center_of_mass.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_pose.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_group.hpp>
#include <tope/task/manipulability.hpp>
#include <tope/task/pointing.hpp>
#include <tope/task/posture.hpp>
#include <tope/task/relative_pose.hpp>
#include <tope/task/rotation_error.hpp>
#include <tope/task/selected_rows.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(task_second_order)
namespace {

constexpr double kFarFromFlip = 2.0;  // rad

/// Largest deviations of error rate and drift over random motions. Skips errors above `skip_above`, where steps are
/// too coarse.
void check_second_order(const Robot& robot, Task& task, int seeds, double skip_above = INFINITY) {
  RobotTerms terms(robot);
  const Vector no_acceleration = Vector::Zero(robot.nv());
  double largest = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    BOOST_TEST_CONTEXT(task.type() << ", seed " << seed) {
      Random random(seed);
      const Vector q = random_position(random, robot, 0.0);
      const Vector v = random.vector(robot.nv());
      const Vector a = random.vector(robot.nv());
      const double t = random.uniform(0.0, 3.0);
      const double h = 1e-4;
      const auto at = [&](double s) {
        terms.update_dynamics(q + s * v + 0.5 * s * s * a, v + s * a);
        task.update_second_order(terms, t + s, no_acceleration);
      };
      at(h);
      const Vector rate_ahead = task.error_rate();
      const Vector ahead = task.error();
      at(-h);
      const Vector rate_behind = task.error_rate();
      const Vector behind = task.error();
      at(0.0);
      if (task.near_flip() || task.error().norm() > skip_above) {
        continue;  // the error may pass pi within the step
      }
      const Vector acceleration = task.jacobian() * a + task.drift();
      BOOST_TEST((task.error_rate() - (ahead - behind) / (2.0 * h)).lpNorm<Eigen::Infinity>() <= 1e-6);
      const double error = (acceleration - (rate_ahead - rate_behind) / (2.0 * h)).lpNorm<Eigen::Infinity>();
      BOOST_TEST(error <= 1e-5 * (1.0 + acceleration.lpNorm<Eigen::Infinity>()));
      largest = std::max(largest, error);
    }
  }
  BOOST_TEST_MESSAGE(task.type() << ": largest deviation of the acceleration " << largest);
}

}  // namespace

BOOST_AUTO_TEST_CASE(frame_position_accelerates) {
  const Robot robot = youbot();
  Random random(11);
  FramePosition fixed(robot, "ee", Vector3(random.vector(3)));
  check_second_order(robot, fixed, 50);
  FramePosition moving(robot, "ee",
                       moving_along_sine(Vector3(random.vector(3)), Vector3(random.vector(3)), 0.5));
  check_second_order(robot, moving, 50);
}

BOOST_AUTO_TEST_CASE(frame_orientation_accelerates) {
  const Robot robot = youbot();
  Random random(12);
  for (int i = 0; i < 5; ++i) {
    FrameOrientation fixed(robot, "ee", random.rotation());
    check_second_order(robot, fixed, 40);
    FrameOrientation spinning_target(robot, "arm_link_4", spinning(random.rotation(), random.vector(3, 0.4)));
    check_second_order(robot, spinning_target, 40);
  }
}

BOOST_AUTO_TEST_CASE(frame_pose_accelerates) {
  const Robot robot = youbot();
  Random random(13);
  FramePose moving(robot, "ee", moving_along_sine(Vector3(random.vector(3)), Vector3(random.vector(3)), 0.3),
                   spinning(random.rotation(), random.vector(3, 0.4)));
  check_second_order(robot, moving, 100);
}

BOOST_AUTO_TEST_CASE(joint_tasks_accelerate) {
  const Robot robot = youbot();
  Random random(14);
  Posture posture(robot, random.vector(robot.nq()));
  check_second_order(robot, posture, 30);
}

BOOST_AUTO_TEST_CASE(pointing_accelerates) {
  const Robot robot = youbot();
  Random random(17);
  for (int i = 0; i < 5; ++i) {
    Pointing fixed(robot, "ee", Vector3(random.vector(3)), Vector3(8.0 * random.unit()));
    check_second_order(robot, fixed, 40, kFarFromFlip);
    Pointing moving(robot, "arm_link_4", Vector3::UnitZ(),
                    moving_along_sine(Vector3(8.0 * random.unit()), Vector3(random.vector(3)), 0.5));
    check_second_order(robot, moving, 40, kFarFromFlip);
  }
}

BOOST_AUTO_TEST_CASE(center_of_mass_accelerates) {
  const Robot robot = youbot();
  Random random(18);
  CenterOfMass moving(robot, moving_along_sine(Vector3(random.vector(3)), Vector3(random.vector(3)), 0.5));
  check_second_order(robot, moving, 50);
}

BOOST_AUTO_TEST_CASE(manipulability_accelerates) {
  const Robot robot = youbot();
  Manipulability all(robot, "ee", 0.5);
  check_second_order(robot, all, 50);
  for (const char* frame : {"ee", "arm_link_4"}) {
    Manipulability position(
        robot, frame, 0.1,
        {.rows = {0, 1, 2},
         .joints = {"arm_joint_1", "arm_joint_2", "arm_joint_3", "arm_joint_4", "arm_joint_5"}});
    check_second_order(robot, position, 50);
    Manipulability one(robot, frame, 0.5, {.rows = {2}});
    check_second_order(robot, one, 50);
  }
}

BOOST_AUTO_TEST_CASE(relative_pose_accelerates) {
  const Robot robot = youbot();
  Random random(20);
  for (const auto& [frame, seen_from] :
       {std::pair{"ee", "base_link"}, {"arm_link_2", "ee"}, {"base_link", "arm_link_4"}}) {
    RelativePose moving(
        robot, frame, seen_from,
        {.position = moving_along_sine(Vector3(random.vector(3)), Vector3(random.vector(3)), 0.3),
         .rotation = spinning(random.rotation(), random.vector(3, 0.4))});
    check_second_order(robot, moving, 100);
    RelativePose position(robot, frame, seen_from, {.position = PointTarget{random.vector(3)}});
    check_second_order(robot, position, 50);
  }
}

BOOST_AUTO_TEST_CASE(updates_allocate_nothing) {
  const Robot robot = youbot();
  Random random(24);
  const std::vector<PointWaypoint> points{
      {0.0, random.vector(3)}, {1.0, random.vector(3)}, {3.0, random.vector(3)}};
  const FramePose pose(robot, "ee", through(points), spinning(random.rotation(), random.vector(3, 0.4)));
  RelativePose relative(robot, "ee", "base_link",
                        {.position = through(points), .rotation = RotationTarget{random.rotation()}});
  JointGroup group(robot, SelectedRows(pose, {0, 1, 2}),
                   {"base_x", "arm_joint_2", "arm_joint_3", "arm_joint_4"});
  Manipulability all(robot, "ee", 0.5);
  RobotTerms terms(robot);
  const Vector no_acceleration = Vector::Zero(robot.nv());
  const Vector q = random_position(random, robot, 0.0);
  for (Task* task : {static_cast<Task*>(&relative), static_cast<Task*>(&group), static_cast<Task*>(&all)}) {
    const NoAllocation guard(std::string(task->type()));
    for (const double t : {0.0, 0.5, 4.0}) {
      terms.update_dynamics(q, no_acceleration);
      task->update(terms, t);
      task->update_second_order(terms, t, no_acceleration);
    }
  }
}

BOOST_AUTO_TEST_CASE(selected_rows_accelerate) {
  const Robot robot = youbot();
  Random random(19);
  const FramePose pose(robot, "ee",
                       moving_along_sine(Vector3(random.vector(3)), Vector3(random.vector(3)), 0.3),
                       spinning(random.rotation(), random.vector(3, 0.4)));
  SelectedRows rows(pose, {5, 2, 3});
  check_second_order(robot, rows, 50);
}

BOOST_AUTO_TEST_CASE(damping_brakes_in_proportion) {
  const Robot robot = youbot();
  RobotTerms terms(robot);
  Random random(15);
  const Vector v = random.vector(8);
  terms.update_dynamics(random.vector(8), v);
  Damping damping(robot, 3.0);
  damping.update_second_order(terms, 0.0, Vector::Zero(8));
  BOOST_TEST((damping.acceleration() + 3.0 * v).norm() <= 1e-14);
}

BOOST_AUTO_TEST_CASE(rate_of_the_inverse_right_jacobian_is_its_derivative) {
  Random random(16);
  for (const double angle : {1e-9, 1e-5, 0.009, 0.011, 0.5, 2.0, 3.0}) {
    const Vector3 e = angle * Vector3(random.vector(3)).normalized();
    const Vector3 rate = random.vector(3);
    const double h = 1e-6;
    const Matrix3 expected =
        (inverse_right_jacobian(e + h * rate) - inverse_right_jacobian(e - h * rate)) / (2.0 * h);
    BOOST_TEST((inverse_right_jacobian_rate(e, rate) - expected).lpNorm<Eigen::Infinity>() <= 1e-8);
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
