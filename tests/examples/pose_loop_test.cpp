// PoseLoop, the part of examples/ros2_controller that needs no ROS: goals reached and changed without a jump, limits
// kept, stops, the heap. Not here: its ROS part, which is not built with the project.
#include "pose_loop.hpp"

#include "support/no_allocation.hpp"
#include "support/text.hpp"

#include <tope/robot/robot_terms.hpp>
#include <tope/task/rotation_error.hpp>

#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(pose_loop)
namespace {

using tope_ros2_example::PoseLoop;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

PoseLoop::Options options(double dt = 1e-3) {
  return {.urdf = source_path("robots/youbot/youbot.urdf"),
          .config = source_path("robots/youbot/youbot.yaml"),
          .dt = dt};
}

/// A PoseLoop and a robot that follows its commands.
struct Robotic {
  explicit Robotic(double period = 1e-3) : dt(period), loop(options(period)) {
    q << 0.0, 0.0, 0.0, 0.0, 0.4, 0.9, 0.6, 1.8;
    loop.start(q);
  }

  bool step() {
    const Vector last = u;
    const bool goes = loop.step(q, u, dt, u);
    jump = std::max(jump, (u - last).cwiseQuotient(loop.robot().velocity_limit()).lpNorm<Eigen::Infinity>());
    q += dt * u;
    return goes;
  }

  double dt;
  PoseLoop loop;
  Vector q{8};
  Vector u = Vector::Zero(8);
  double jump = 0.0;
};

}  // namespace

BOOST_AUTO_TEST_CASE(stands_still_without_a_goal) {
  Robotic robot;
  const Vector start = robot.q;
  for (int i = 0; i < 100; ++i) {
    BOOST_TEST(robot.step());
  }
  BOOST_TEST((robot.q - start).lpNorm<Eigen::Infinity>() <= 1e-9);
}

BOOST_AUTO_TEST_CASE(reaches_goals_and_changes_them_without_a_jump_or_the_heap) {
  Robotic robot;
  const Matrix3 turned = Eigen::AngleAxisd(2.0, Vector3(0.2, 1.0, 0.1).normalized()).toRotationMatrix();
  double least_room = 1.0;
  {
    const NoAllocation guard("steps and goals");
    for (int cycle = 0; cycle < 12000; ++cycle) {
      if (cycle == 1000) {
        robot.loop.aim(Vector3(2.0, 0.5, 0.3), Matrix3::Identity());
      }
      if (cycle == 2000) {  // before the first is reached
        robot.loop.aim(Vector3(0.7, 0.2, 0.3), turned);
      }
      const bool goes = robot.loop.step(robot.q, robot.u, 1e-3, robot.u);
      robot.q.noalias() += 1e-3 * robot.u;
      least_room = std::min({least_room, (robot.loop.robot().position_upper() - robot.q).minCoeff(),
                             (robot.q - robot.loop.robot().position_lower()).minCoeff()});
      if (!goes) {
        break;
      }
    }
  }
  RobotTerms terms(robot.loop.robot());
  terms.update(robot.q, robot.u);
  const int ee = robot.loop.robot().frame_index("ee");
  BOOST_TEST((terms.frame_position(ee) - Vector3(0.7, 0.2, 0.3)).norm() <= 1e-3);
  BOOST_TEST(rotation_vector(terms.frame_rotation(ee) * turned.transpose()).norm() <= 1e-3);
  BOOST_TEST(least_room >= 0.0);
}

/// Largest change of a command from one cycle to the next, over goals that change before they are reached.
double jump_over_goals(double dt) {
  Robotic robot(dt);
  const auto cycles = std::lround(0.5 / dt);
  for (long cycle = 0; cycle < 6 * cycles; ++cycle) {
    if (cycle % cycles == 0) {
      const double side = cycle % (2 * cycles) == 0 ? 0.05 : -0.05;
      robot.loop.aim(Vector3(0.65, side, 0.3), Matrix3::Identity());
    }
    robot.step();
  }
  return robot.jump;
}

BOOST_AUTO_TEST_CASE(a_new_goal_makes_no_jump) {
  const double coarse = jump_over_goals(1e-3);
  const double fine = jump_over_goals(1e-4);
  BOOST_TEST(coarse >= 8.0 * fine);
}

BOOST_AUTO_TEST_CASE(ignores_numbers_that_are_no_pose) {
  const Vector3 away(1.0, 1.0, 1.0);
  const Matrix3 straight = Matrix3::Identity();
  BOOST_TEST(PoseLoop::is_pose(away, straight));
  const std::vector<std::pair<Vector3, Matrix3>> none{{Vector3(kNaN, 0.0, 0.0), straight},
                                                      {away, 2.0 * straight},
                                                      {away, -straight},
                                                      {away, kNaN * straight}};
  for (const auto& [position, rotation] : none) {
    Robotic robot;
    BOOST_TEST(!PoseLoop::is_pose(position, rotation));
    robot.loop.aim(position, rotation);
    for (int i = 0; i < 10; ++i) {
      robot.step();
    }
    BOOST_TEST(robot.u.isZero(1e-9));
    robot.loop.aim(away, straight);
    for (int i = 0; i < 10; ++i) {
      robot.step();
    }
    BOOST_TEST(robot.u.norm() > 1e-3);
  }
}

BOOST_AUTO_TEST_CASE(bears_few_bad_states_and_stops_for_good_after_more) {
  Robotic robot;
  robot.loop.aim(Vector3(0.7, 0.2, 0.3), Matrix3::Identity());
  const Vector broken = Vector::Constant(8, kNaN);
  for (int cycle = 0; cycle < 300; ++cycle) {
    robot.step();
  }
  for (int i = 0; i < options().patience; ++i) {
    BOOST_TEST(robot.loop.step(broken, robot.u, 1e-3, robot.u));
    BOOST_TEST(robot.u.isZero(0.0));
    BOOST_TEST(robot.loop.status().has(Event::bad_input));
  }
  BOOST_TEST(robot.step());
  BOOST_TEST(robot.u.norm() > 1e-3);
  for (int i = 0; i < options().patience; ++i) {
    BOOST_TEST(robot.loop.step(broken, robot.u, 1e-3, robot.u));
  }
  BOOST_TEST(!robot.loop.step(broken, robot.u, 1e-3, robot.u));
  BOOST_TEST(!robot.step());
  BOOST_TEST(robot.u.isZero(0.0));
  robot.loop.start(robot.q);
  BOOST_TEST(robot.step());
}

BOOST_AUTO_TEST_CASE(stops_when_cycles_keep_coming_late) {
  Robotic robot;
  for (int i = 0; i < options().patience; ++i) {
    BOOST_TEST(robot.loop.step(robot.q, robot.u, 2.5e-3, robot.u));
  }
  BOOST_TEST(!robot.loop.step(robot.q, robot.u, 2.5e-3, robot.u));
}

BOOST_AUTO_TEST_CASE(stands_still_before_it_is_started) {
  PoseLoop loop(options());
  Vector u = Vector::Ones(8);
  BOOST_TEST(!loop.step(Vector::Zero(8), Vector::Zero(8), 1e-3, u));
  BOOST_TEST(u.isZero(0.0));
}

BOOST_AUTO_TEST_CASE(mistakes_are_found_when_it_is_built) {
  PoseLoop::Options wrong = options();
  wrong.frame = "eee";
  check_error([&] { PoseLoop loop(wrong); }, {"unknown frame 'eee'", "'ee'"});
  wrong = options();
  wrong.dt = 0.5;
  check_error([&] { PoseLoop loop(wrong); }, {"limits are not safe"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
