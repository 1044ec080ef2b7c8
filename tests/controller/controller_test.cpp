// Controller: options, handles and their errors; bad input; events; bounds, limits and goals in closed
// loop; repeated runs. Not here: transitions (controller_transition_test), the heap
// (controller_no_allocation_test).
#include "support/loop.hpp"
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_pose.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_position.hpp>
#include <tope/task/posture.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(controller)
namespace {

const Vector3 goal_position(0.490, 0.105, 0.068);

/// A goal that takes joints to their limits: turn, then reach.
void add_hard_goal(Controller& controller) {
  Random random(11);
  controller.add(1, FrameOrientation(controller.robot(), "ee", random.rotation()));
  controller.add(2, FramePosition(controller.robot(), "ee", goal_position));
}

bool keeps_limits(LimitMethod method) {
  return method == LimitMethod::unilateral || method == LimitMethod::chain ||
         method == LimitMethod::multilinear;
}

}  // namespace

BOOST_AUTO_TEST_CASE(reaches_goals_that_are_free) {
  for (const std::string& name : limit_method_names()) {
    BOOST_TEST_CONTEXT(name) {
      Loop loop(youbot(), {.limits = {.method = limit_method_from(name)}});
      const TaskHandle pose =
          loop.controller.add(1, FramePosition(loop.robot, "ee", Vector3(0.6, 0.2, 0.4), Exponential(4.0)));
      loop.run(4.0);
      BOOST_TEST(loop.controller.task(pose).error().norm() <= 1e-4);
    }
  }
}

BOOST_AUTO_TEST_CASE(keeps_bounds_and_limits) {
  for (const std::string& name : limit_method_names()) {
    BOOST_TEST_CONTEXT(name) {
      const LimitMethod method = limit_method_from(name);
      Loop loop(youbot_before_obstacle(), {.limits = {.method = method}});
      add_hard_goal(loop.controller);
      double excess = -INFINITY;
      double beyond = -INFINITY;
      loop.run(3.0, [&] {
        excess = std::max(excess, (loop.u.cwiseAbs() - loop.robot.velocity_limit()).maxCoeff());
        beyond = std::max(beyond, loop.beyond());
      });
      BOOST_TEST(excess <= 1e-9);
      if (keeps_limits(method)) {
        BOOST_TEST(beyond <= 0.0);
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(keeps_limits_for_random_goals) {
  for (const LimitMethod method : {LimitMethod::unilateral, LimitMethod::chain}) {
    double furthest = -INFINITY;
    for (int seed = 0; seed < 10; ++seed) {
      BOOST_TEST_CONTEXT(to_string(method) << ", seed " << seed) {
        Random random(seed);
        Loop loop(youbot_before_obstacle(), {.dt = 2e-3, .limits = {.method = method}});
        loop.q = random_position(random, loop.robot, 0.2);
        loop.q[0] = 0.0;
        loop.controller.add(1, FrameOrientation(loop.robot, "ee", random.rotation()));
        loop.controller.add(2, FramePosition(loop.robot, "ee", Vector3(random.vector(3, 0.5))));
        loop.run(2.0, [&] { furthest = std::max(furthest, loop.beyond()); });
        BOOST_TEST(furthest <= 0.0);
      }
    }
    BOOST_TEST_MESSAGE(to_string(method) << ": furthest beyond a limit " << furthest);
  }
}

BOOST_AUTO_TEST_CASE(moves_joints_without_any_bound) {
  const TemporaryFile file("robot.urdf",
                           R"(<robot name="spinner"><link name="l0"/><link name="l1"/><link name="l2"/>
    <joint name="a" type="continuous"><parent link="l0"/><child link="l1"/><axis xyz="0 0 1"/></joint>
    <joint name="b" type="revolute"><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/>
      <limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>)");
  const Robot robot = Robot::from_urdf(file.path());
  for (const std::string& name : limit_method_names()) {
    BOOST_TEST_CONTEXT(name) {
      Controller controller(robot, {.limits = {.method = limit_method_from(name)}});
      controller.add(1, JointPosition(robot, {{"a", 7.0}, {"b", 0.1}}));
      Vector u(2);
      controller.update(Vector::Zero(2), Vector::Zero(2), 0.0, u);
      BOOST_TEST(u[0] > 10.0);
      BOOST_TEST(u[1] > 0.1);
    }
  }
}

BOOST_AUTO_TEST_CASE(leads_back_from_beyond_a_limit) {
  for (const LimitMethod method : {LimitMethod::unilateral, LimitMethod::chain}) {
    BOOST_TEST_CONTEXT(to_string(method)) {
      Loop loop(youbot(), {.limits = {.method = method}});
      loop.controller.add(1, Posture(loop.robot, loop.q));
      loop.q[4] = loop.robot.position_upper()[4] + 0.05;
      const double first = loop.beyond();
      loop.step();
      BOOST_TEST(loop.controller.status().has(Event::beyond));
      BOOST_TEST(loop.controller.status().beyond_joint == 4);
      BOOST_TEST(loop.beyond() < first);
      loop.run(1.0);
      BOOST_TEST(loop.beyond() < 0.0);
      BOOST_TEST(!loop.controller.status().has(Event::beyond));
    }
  }
}

BOOST_AUTO_TEST_CASE(reports_what_acts) {
  Loop loop(youbot(), {.limits = {.method = LimitMethod::chain}});
  loop.step();
  BOOST_TEST(loop.controller.status().ok());
  BOOST_TEST(event_names(loop.controller.status()) == "ok");

  loop.controller.add(1, FramePosition(loop.robot, "ee", Vector3(50.0, 0.0, 0.0)));
  loop.step();
  BOOST_TEST(loop.controller.status().has(Event::scaled));
  BOOST_TEST(loop.controller.status().scale < 1.0);
  BOOST_TEST((loop.controller.status().bound_joint >= 0));

  loop.q[7] = loop.robot.position_upper()[7] - 0.01;
  loop.step();
  BOOST_TEST(loop.controller.status().has(Event::limit));
  BOOST_TEST(loop.controller.status().limit_joint == 7);
  BOOST_TEST(loop.controller.upper_activation()[7] > 0.5);
  BOOST_TEST(loop.controller.lower_activation()[7] == 0.0);
  BOOST_TEST(describe(loop.controller.status(), loop.robot).find("arm_joint_5") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(reports_a_direction_that_a_higher_level_took) {
  Loop loop(youbot(), {.limits = {.method = LimitMethod::chain}});
  loop.controller.add(1, FramePosition(loop.robot, "ee", Vector3(0.5, 0.0, 0.3)));
  loop.step();
  BOOST_TEST(!loop.controller.status().has(Event::singular));
  loop.controller.add(2, FramePosition(loop.robot, "ee", Vector3(0.4, 0.1, 0.3)));
  loop.step();
  BOOST_TEST(loop.controller.status().has(Event::singular));
}

BOOST_AUTO_TEST_CASE(reports_an_orientation_about_to_flip) {
  Loop loop(youbot(), {});
  RobotTerms terms(loop.robot);
  terms.update(loop.q, loop.u);
  Matrix3 half_turn = terms.frame_rotation(loop.robot.frame_index("ee"));
  half_turn.col(0) *= -1.0;
  half_turn.col(1) *= -1.0;
  loop.controller.add(1, FrameOrientation(loop.robot, "ee", half_turn));
  loop.step();
  BOOST_TEST(loop.controller.status().has(Event::near_flip));
}

BOOST_AUTO_TEST_CASE(bad_input_stops_the_robot_and_changes_nothing) {
  // two controllers in the middle of a transition; one is fed bad input between the cycles
  Loop clean(youbot_before_obstacle(), {});
  Loop disturbed(youbot_before_obstacle(), {});
  TaskHandle entering;
  for (Loop* loop : {&clean, &disturbed}) {
    loop->controller.add(1, FrameOrientation(loop->robot, "ee", Matrix3::Identity(), PredefinedTime(1.0)));
    entering = loop->controller.add(2, FramePosition(loop->robot, "ee", goal_position, PredefinedTime(1.0)),
                                    {.over = 0.2});
  }
  Controller& controller = disturbed.controller;
  const auto disturb = [&](const Vector& q, const Vector& v, double t, Eigen::Index size) {
    Vector u = Vector::Ones(size);
    const Vector upper_activation = controller.upper_activation();
    const double activation = controller.activation(entering);
    const Vector error = controller.task(entering).error();
    const Status& status = controller.update(q, v, t, u);
    BOOST_TEST(event_names(status) == "bad_input");
    BOOST_TEST(describe(status, disturbed.robot).find("no motion") != std::string::npos);
    BOOST_TEST(u.norm() == 0.0);
    BOOST_TEST((controller.upper_activation() - upper_activation).norm() == 0.0);
    BOOST_TEST(controller.activation(entering) == activation);
    BOOST_TEST((controller.task(entering).error() - error).norm() == 0.0);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vector v = Vector::Zero(8);
  Vector bad_q = clean.q;
  bad_q[3] = nan;
  Vector bad_v = v;
  bad_v[7] = INFINITY;
  disturb(bad_q, v, 50.0, 8);  // before anything has started
  for (int cycle = 0; cycle < 300; ++cycle) {
    clean.step();
    disturbed.step();
    BOOST_TEST((clean.u - disturbed.u).norm() == 0.0);
    const double later = clean.t + 0.05;
    disturb(bad_q, v, later, 8);
    disturb(clean.q, bad_v, later, 8);
    disturb(clean.q, v, nan, 8);
    disturb(clean.q, v, INFINITY, 8);
    disturb(clean.q.head(7), v, later, 8);
    disturb(clean.q, Vector::Zero(9), later, 8);
    disturb(clean.q, v, later, 7);
  }
  BOOST_TEST(clean.u.norm() > 0.0);
}

BOOST_AUTO_TEST_CASE(repeated_runs_are_bit_identical) {
  for (const std::string& name : limit_method_names()) {
    BOOST_TEST_CONTEXT(name) {
      const auto commands = [&] {
        Loop loop(youbot_before_obstacle(), {.limits = {.method = limit_method_from(name)}});
        add_hard_goal(loop.controller);
        const TaskHandle posture =
            loop.controller.add(3, Posture(loop.robot, Vector::Zero(8)), {.over = 0.1});
        std::vector<double> all;
        loop.run(0.3, [&] { all.insert(all.end(), loop.u.begin(), loop.u.end()); });
        loop.controller.remove(posture, {.over = 0.1});
        loop.run(0.3, [&] { all.insert(all.end(), loop.u.begin(), loop.u.end()); });
        return all;
      };
      BOOST_TEST((commands() == commands()));
    }
  }
}

BOOST_AUTO_TEST_CASE(levels_are_sorted_and_equal_levels_share) {
  // a posture on level 2 must not move what level 1 holds, in whichever order they are added
  const Robot robot = youbot();
  Loop first(robot, {});
  Loop second(robot, {});
  const FramePosition reach(robot, "ee", goal_position);
  const Posture posture(robot, Vector::Zero(8));
  first.controller.add(1, reach);
  first.controller.add(5, posture);
  second.controller.add(5, posture);
  second.controller.add(1, reach);
  first.step();
  second.step();
  BOOST_TEST((first.u - second.u).norm() == 0.0);
  Loop shared(robot, {});
  shared.controller.add(1, reach);
  shared.controller.add(1, posture);
  shared.step();
  BOOST_TEST((shared.u - first.u).norm() > 1e-3);
}

BOOST_AUTO_TEST_CASE(joint_weights_move_cheap_joints_first) {
  const auto base_motion = [](std::vector<double> weights) {
    Loop loop(youbot(), {.limits = {.method = LimitMethod::none}, .joint_weights = std::move(weights)});
    loop.controller.add(1, FramePosition(loop.robot, "ee", Vector3(0.5, 0.1, 0.3)));
    loop.step();
    return loop.u.head(2).norm();
  };
  BOOST_TEST(base_motion({100.0, 100.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0}) < 0.5 * base_motion({}));
}

BOOST_AUTO_TEST_CASE(bad_options_are_refused) {
  const Robot robot = youbot();
  const auto refuse = [&](const ControllerOptions& options, std::initializer_list<std::string> parts) {
    check_error([&] { const Controller built(robot, options); }, parts);
  };
  refuse({.dt = 0.0}, {"dt", "positive", "0.0"});
  refuse({.dt = NAN}, {"dt", "finite"});
  refuse({.limits = {.rows = {.gain = -1.0}}}, {"limits: gain", "positive"});
  refuse({.limits = {.rows = {.buffer = 2.0}}}, {"overlap"});
  refuse({.joint_weights = {1.0, 2.0}}, {"joint_weights", "expected 8 values, got 2"});
  refuse({.joint_weights = std::vector<double>(8, -1.0)}, {"joint_weights: base_x", "positive"});
  refuse({.dt = 0.5}, {"limits are not safe", "dt * gain <= 1", "lower limits.gain to at most 2"});
  refuse({.dt = 0.08, .limits = {.method = LimitMethod::chain}},
         {"limits are not safe", "buffer", "raise the buffer of"});
  ControllerOptions unsafe{.dt = 0.5};
  unsafe.limits.enforce_conditions = false;
  BOOST_TEST(!Controller(robot, unsafe).conditions().empty());
}

BOOST_AUTO_TEST_CASE(bad_tasks_and_handles_are_refused) {
  const Robot robot = youbot();
  Controller controller(robot, {});
  const Posture posture(robot, Vector::Zero(8));
  check_error([&] { controller.add(0, posture); }, {"level", "at least 1", "0"});
  check_error([&] { controller.add(1, posture, {.over = -1.0}); }, {"over", "positive", "-1"});
  check_error([&] { controller.add(1, posture, {.over = NAN}); }, {"over", "nan"});
  check_error([&] { controller.remove({}); }, {"no task with handle -1"});
  check_error([&] { controller.remove({42}); }, {"no task with handle 42"});
  check_error([&] { controller.task({42}); }, {"no task with handle 42"});
  check_error([&] { controller.activation({42}); }, {"no task with handle 42"});
  const TaskHandle handle = controller.add(1, posture);
  check_error([&] { controller.remove(handle, {.over = NAN}); }, {"over", "nan"});
  BOOST_TEST(controller.activation(handle) == 1.0);

  RobotConfig config;
  config.locked_joints["base_x"] = 0.0;
  const Robot other = Robot::from_urdf(source_path("robots/youbot/youbot.urdf"), config);
  check_error([&] { controller.add(1, Posture(other, Vector::Zero(other.nq()))); },
              {"task posture", "9 degrees of freedom", "this one has 8"});
}

BOOST_AUTO_TEST_CASE(keeps_its_own_copy_of_robot_and_tasks) {
  Robot robot = youbot();
  FramePosition reach(robot, "ee", goal_position);
  Controller controller(robot, {});
  const TaskHandle handle = controller.add(1, reach);
  robot.set_velocity_limit(Vector::Constant(8, 1e-3));
  BOOST_TEST(controller.robot().velocity_limit()[0] == 0.8);
  Vector u(8);
  controller.update(Vector::Zero(8), Vector::Zero(8), 0.0, u);
  BOOST_TEST(controller.task(handle).error().norm() > 0.0);
  BOOST_TEST(reach.error().norm() == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
