// The controller in torque mode: tasks get the acceleration they ask for, the bias is always compensated, bounds and
// limits hold in closed loop with the rigid-body plant, no allocation, bad input. The paper's law is checked against
// Pinocchio's Python (tests/python/test_torque.py). Not here: the law itself (law room).
#include "support/loop.hpp"
#include "support/no_allocation.hpp"
#include "support/robots.hpp"

#include <tope/controller/controller.hpp>
#include <tope/plant/rigid_body.hpp>
#include <tope/robot/robot_terms.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_position.hpp>
#include <tope/task/posture.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(torque_mode)
namespace {

ControllerOptions options(LimitMethod method, double dt = 1e-3) {
  return {.mode = Mode::torque, .dt = dt, .limits = {.method = method}};
}

Vector start() {
  Vector q(8);
  q << 0.15, 0.0, 0.0, 0.0, 0.4, 0.9, 0.6, 1.8;
  return q;
}

void add_tasks(Controller& controller, const Robot& robot, double duration) {
  const Matrix3 goal = Eigen::Quaterniond(0.0397, 0.9811, 0.1867, -0.0322).normalized().toRotationMatrix();
  const PredefinedTime reference({.duration = duration, .gain = 5.0, .replan_over = 0.5});
  controller.add(1, FrameOrientation(robot, "ee", goal, reference));
  controller.add(2, FramePosition(robot, "ee", Vector3(0.640, 0.105, 0.068), reference));
  controller.add(3, Damping(robot));
}

}  // namespace

BOOST_AUTO_TEST_CASE(starts_from_rest_without_a_step) {
  const Robot robot = youbot_before_obstacle();
  RobotTerms terms(robot);
  terms.update_dynamics(start(), Vector::Zero(8));
  for (const LimitMethod method : {LimitMethod::unilateral, LimitMethod::chain}) {
    Controller controller(robot, options(method));
    add_tasks(controller, robot, 5.0);
    Vector tau(8);
    controller.update(start(), Vector::Zero(8), 0.0, tau);
    BOOST_TEST((tau - terms.bias()).norm() <= 1e-10);
  }
}

BOOST_AUTO_TEST_CASE(task_gets_its_acceleration) {
  const Robot robot = youbot();
  RobotTerms terms(robot);
  for (int seed = 0; seed < 30; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const Vector q = random_position(random, robot, 0.5);
      const Vector v = 0.2 * random.vector(8);
      Controller controller(robot, options(LimitMethod::none));
      terms.update_dynamics(q + 0.5 * controller.options().dt * v, v);
      const Vector3 target = terms.frame_position(robot.frame_index("ee")) + 0.02 * Vector3(random.vector(3));
      const TaskHandle handle = controller.add(1, FramePosition(robot, "ee", target));
      Vector tau(8);
      controller.update(q, v, 0.0, tau);
      if (!controller.status().ok()) {
        continue;  // damped or scaled: not exact by design
      }
      const Vector acceleration = terms.mass_matrix().ldlt().solve(tau - terms.bias());
      const Task& task = controller.task(handle);
      BOOST_TEST((task.jacobian() * acceleration - task.acceleration()).norm() <= 1e-9);
    }
  }
}

/// Largest difference between the acceleration asked for and the one on average, over a swing of the whole arm.
double missed_acceleration(double dt, bool midpoint) {
  Robot robot = packaged_robot("tiago");  // whose wrist weighs next to nothing
  robot.set_effort_limit(Vector::Constant(robot.nv(), 1e4));
  Random random(1);
  const ControllerOptions options{
      .mode = Mode::torque, .dt = dt, .limits = {.method = LimitMethod::none}, .midpoint = midpoint};
  Loop loop(robot, options, random_position(random, robot, 0.05));
  const TaskHandle swing = loop.controller.add(1, Posture(robot, random_position(random, robot, 0.05)));
  double missed = 0.0;
  while (loop.t < 0.4) {
    const Vector before = loop.v;
    loop.step();
    const Vector mean = (loop.v - before) / dt;
    missed = std::max(missed, (mean - loop.controller.task(swing).acceleration()).cwiseAbs().maxCoeff());
  }
  return missed;
}

BOOST_AUTO_TEST_CASE(the_middle_of_the_period_makes_accelerations_exact_to_second_order) {
  const double coarse = missed_acceleration(4e-3, true);
  const double fine = missed_acceleration(2e-3, true);
  BOOST_TEST_MESSAGE("missed by " << coarse << " at 4 ms, " << fine << " at 2 ms");
  BOOST_TEST(coarse >= 3.5 * fine);
  const double measured_coarse = missed_acceleration(4e-3, false);
  const double measured_fine = missed_acceleration(2e-3, false);
  BOOST_TEST_MESSAGE("at the measured state by " << measured_coarse << ", " << measured_fine);
  BOOST_TEST(measured_coarse < 2.5 * measured_fine);
  BOOST_TEST(measured_fine >= 20.0 * fine);
}

BOOST_AUTO_TEST_CASE(closed_loop_keeps_limits_and_bounds) {
  const Robot robot = youbot_before_obstacle();
  for (const LimitMethod method : {LimitMethod::unilateral, LimitMethod::chain, LimitMethod::multilinear}) {
    BOOST_TEST_CONTEXT(to_string(method)) {
      Controller controller(robot, options(method));
      add_tasks(controller, robot, 0.5);  // fast: bounds and limits are met
      RigidBody plant(robot, {}, 1e-3);
      plant.reset(start());
      Vector tau = Vector::Zero(8);
      double beyond = -1.0;
      double excess = -1e9;
      bool scaled = false;
      for (int i = 0; i < 4000; ++i) {
        controller.update(plant.position(), plant.velocity(), i * 1e-3, tau);
        excess = std::max(excess, (tau.cwiseAbs() - robot.effort_limit()).maxCoeff());
        const Eigen::Vector3d wrench = robot.base()->base_wrench(tau, plant.position()[2]);
        excess = std::max(excess, robot.base()->minimum_norm_torques(wrench).cwiseAbs().maxCoeff() - 2.137);
        plant.step(tau, 1e-3);
        const Vector& q = plant.position();
        beyond =
            std::max(beyond, (q - robot.position_upper()).cwiseMax(robot.position_lower() - q).maxCoeff());
        scaled = scaled || controller.status().has(Event::scaled);
      }
      BOOST_TEST(beyond < 0.0);
      BOOST_TEST(excess <= 1e-9);
      BOOST_TEST(scaled);
    }
  }
}

BOOST_AUTO_TEST_CASE(never_allocates) {
  for (const std::string& name : limit_method_names()) {
    for (const NullSpace null_space : {NullSpace::compensated, NullSpace::zero_torque}) {
      BOOST_TEST_CONTEXT(name) {
        const Robot robot = youbot_before_obstacle();
        ControllerOptions chosen = options(limit_method_from(name));
        chosen.null_space = null_space;
        chosen.wheel_distribution = WheelDistribution::minimum_peak;
        Controller controller(robot, chosen);
        add_tasks(controller, robot, 1.0);
        const TaskHandle leaving = controller.add(2, FramePosition(robot, "arm_link_3", Vector3::Zero()));
        controller.remove(leaving, {.over = 0.02});
        Vector q = start();
        Vector v = Vector::Zero(8);
        Vector tau(8);
        const NoAllocation guard(name);
        for (int i = 0; i < 40; ++i) {
          q[7] = robot.position_upper()[7] - 0.005 * i;
          q[0] = 0.35 - 0.004 * i;
          v[7] = 0.01 * i;
          controller.update(q, v, i * 1e-3, tau);
        }
        q.setZero();  // the arm stretched
        controller.update(q, v, 0.05, tau);
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(bad_input_holds_the_arm_up) {
  const Robot robot = youbot();
  Controller controller(robot, options(LimitMethod::unilateral));
  add_tasks(controller, robot, 1.0);
  RobotTerms terms(robot);
  terms.update_dynamics(start(), Vector::Zero(8));
  Vector tau(8);
  controller.update(start(), Vector::Zero(8), 0.0, tau);
  controller.update(Vector::Constant(8, NAN), Vector::Zero(8), 0.001, tau);
  BOOST_TEST(controller.status().has(Event::bad_input));
  BOOST_TEST((tau - terms.bias()).norm() <= 1e-12);
  Vector small(3);
  controller.update(start(), Vector::Zero(8), 0.002, small);
  BOOST_TEST(small.norm() == 0.0);
}

BOOST_AUTO_TEST_CASE(a_target_beyond_all_numbers_holds_the_arm_up_until_it_is_gone) {
  const Robot robot = youbot();
  Controller controller(robot, options(LimitMethod::unilateral));
  RobotTerms terms(robot);
  terms.update_dynamics(start(), Vector::Zero(8));
  const TaskHandle absurd =
      controller.add(1, JointPosition(robot, {{"arm_joint_1", 1e308}}, Exponential(60.0)), {.over = 0.0});
  Vector tau(8);
  for (int i = 0; i < 3; ++i) {
    controller.update(start(), Vector::Zero(8), i * 1e-3, tau);
    BOOST_TEST(controller.status().has(Event::bad_input));
    BOOST_TEST((tau - terms.bias()).norm() <= 1e-12);
  }
  controller.remove(absurd, {.over = 0.0});
  add_tasks(controller, robot, 1.0);
  controller.update(start(), Vector::Zero(8), 0.003, tau);
  BOOST_TEST(!controller.status().has(Event::bad_input));
  BOOST_TEST(tau.allFinite());
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
