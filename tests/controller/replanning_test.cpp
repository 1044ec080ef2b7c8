// A task with a predefined time that a higher level holds back for a while: the status says so, and on release a
// reference that may plans anew, without a jump and more gently than one that hurries after its old plan. In both
// modes. Not here: the plans themselves (reference room).
#include "support/robots.hpp"

#include <tope/controller/controller.hpp>
#include <tope/plant/kinematic.hpp>
#include <tope/plant/rigid_body.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_position.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <memory>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(replanning)
namespace {

constexpr double kDuration = 3.0;    // promised [s]
constexpr double kReleaseAt = 2.8;   // s
constexpr double kReplanOver = 2.0;  // s
constexpr double kFade = 0.2;        // of the task that holds it [s]
constexpr double kNewArrival = kReleaseAt + kFade + kReplanOver;

struct Outcome {
  int held = 0;               // cycles
  bool held_after = false;    // once it was free
  double peak = 0.0;          // largest command after the release, share of the bound
  double largest_jump = 0.0;  // of the command after the release, share of the bound
  double error_at_arrival = 0.0;
};

Outcome pursue(Mode mode, double replan_over, double dt) {
  const Robot robot = youbot();
  Controller controller(robot, {.mode = mode, .dt = dt});
  std::unique_ptr<Plant> plant = std::make_unique<Kinematic>(robot);
  if (mode == Mode::torque) {
    plant = std::make_unique<RigidBody>(robot, RigidBodyOptions{}, dt);
  }
  Vector q(8);
  q << 0.0, 0.0, 0.0, 0.0, 0.4, 0.9, 0.6, 0.0;
  plant->reset(q);
  RobotTerms terms(robot);
  terms.update(q, Vector::Zero(8));
  const Vector3 here = terms.frame_position(robot.frame_index("ee"));
  const TaskHandle anchor = controller.add(1, FramePosition(robot, "ee", here));
  const TaskHandle reach = controller.add(
      2, FramePosition(robot, "ee", here + Vector3(0.3, 0.1, -0.05),
                       PredefinedTime({.duration = kDuration, .gain = 10.0, .replan_over = replan_over})));
  controller.add(3, Damping(robot));
  const Vector& bound = mode == Mode::torque ? robot.effort_limit() : robot.velocity_limit();

  Outcome outcome;
  Vector u = Vector::Zero(8);
  Vector resting = u;
  const auto cycles = static_cast<int>(std::lround(kNewArrival / dt));
  const auto release = static_cast<int>(std::lround(kReleaseAt / dt));
  for (int i = 0; i <= cycles; ++i) {
    if (i == release) {
      controller.remove(anchor, {.over = kFade});
      resting = u;
    }
    const Vector last = u;
    controller.update(plant->position(), plant->velocity(), i * dt, u);
    outcome.held += controller.status().has(Event::held) ? 1 : 0;
    if (i > release) {
      outcome.peak = std::max(outcome.peak, (u - resting).cwiseQuotient(bound).cwiseAbs().maxCoeff());
      outcome.largest_jump =
          std::max(outcome.largest_jump, (u - last).cwiseQuotient(bound).cwiseAbs().maxCoeff());
    }
    outcome.held_after = controller.status().has(Event::held);
    plant->step(u, dt);
  }
  outcome.error_at_arrival = controller.task(reach).error().norm();
  return outcome;
}

}  // namespace

BOOST_AUTO_TEST_CASE(new_plan_is_gentler_and_arrives) {
  for (const Mode mode : {Mode::velocity, Mode::torque}) {
    BOOST_TEST_CONTEXT((mode == Mode::velocity ? "velocity" : "torque")) {
      const Outcome hurried = pursue(mode, 0.0, 1e-3);
      const Outcome planned = pursue(mode, kReplanOver, 1e-3);
      BOOST_TEST(planned.held > 2000);
      BOOST_TEST(!planned.held_after);
      BOOST_TEST(planned.error_at_arrival < 1e-3);
      BOOST_TEST(planned.peak < 0.8 * hurried.peak);
    }
  }
}

BOOST_AUTO_TEST_CASE(release_makes_no_jump) {
  for (const Mode mode : {Mode::velocity, Mode::torque}) {
    BOOST_TEST_CONTEXT((mode == Mode::velocity ? "velocity" : "torque")) {
      const Outcome coarse = pursue(mode, kReplanOver, 1e-3);
      const Outcome fine = pursue(mode, kReplanOver, 1e-4);
      BOOST_TEST(coarse.largest_jump > 8.0 * fine.largest_jump);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
