// Tasks that come and go: activations over time, commands that stay continuous (their largest jump falls
// with the period), what a task added at once does, and handles of tasks that are gone. Not here:
// orientation errors that pass pi, where a command jumps by definition and the status says so.
#include "support/loop.hpp"
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/posture.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>

namespace tope::test {
namespace {

/// Largest change of a command between cycles, over the joint's bound, while tasks come, overlap and go.
double largest_jump(LimitMethod method, int seed, double dt) {
  Random random(seed);
  Loop loop(youbot_before_obstacle(), {.dt = dt, .limits = {.method = method}});
  const FramePosition reach(loop.robot, "ee", Vector3(0.5, 0.1, 0.2) + Vector3(random.vector(3, 0.1)));
  const FrameOrientation turn(loop.robot, "ee", random.rotation());
  const Posture rest(loop.robot, random_position(random, loop.robot, 0.3));
  double jump = 0.0;
  Vector last;
  const auto observe = [&] {
    if (last.size() > 0) {
      jump =
          std::max(jump, ((loop.u - last).cwiseQuotient(loop.robot.velocity_limit())).cwiseAbs().maxCoeff());
    }
    last = loop.u;
  };
  const TaskHandle posture = loop.controller.add(3, rest);
  const TaskHandle first = loop.controller.add(1, reach);
  loop.run(0.1, observe);
  const TaskHandle second = loop.controller.add(2, turn, {.over = 0.3});
  loop.run(0.1, observe);
  loop.controller.remove(posture, {.over = 0.15});
  loop.run(0.1, observe);
  loop.controller.remove(second, {.over = 0.1});  // before it has arrived
  loop.run(0.15, observe);
  loop.controller.add(1, turn, {.over = 0.2});
  loop.controller.remove(first, {.over = 0.3});
  loop.run(0.4, observe);
  return jump;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(controller_transition)

BOOST_AUTO_TEST_CASE(commands_stay_continuous) {
  for (const LimitMethod method : {LimitMethod::unilateral, LimitMethod::chain}) {
    double lowest = INFINITY;
    for (int seed = 0; seed < 12; ++seed) {
      BOOST_TEST_CONTEXT(to_string(method) << ", seed " << seed) {
        const double coarse = largest_jump(method, seed, 1e-3);
        const double fine = largest_jump(method, seed, 1e-4);
        BOOST_TEST(coarse / fine >= 8.0);
        BOOST_TEST_MESSAGE(to_string(method)
                           << ": largest jump " << coarse << ", " << fine << " of the bound");
        lowest = std::min(lowest, coarse / fine);
      }
    }
    BOOST_TEST_MESSAGE(to_string(method) << ": lowest ratio " << lowest);
  }
}

BOOST_AUTO_TEST_CASE(activations_rise_and_fall_as_told) {
  Loop loop(youbot(), {});
  Controller& controller = loop.controller;
  const Posture rest(loop.robot, Vector::Zero(8));
  const TaskHandle handle = controller.add(1, rest, {.over = 0.1});
  BOOST_TEST(controller.activation(handle) == 0.0);
  loop.step();
  BOOST_TEST(controller.activation(handle) == 0.0);  // counts from the first update
  loop.run(0.05);
  BOOST_TEST(std::abs(controller.activation(handle) - 0.5) <= 1e-9);
  loop.run(0.05);
  BOOST_TEST(std::abs(controller.activation(handle) - 1.0) <= 1e-9);
  controller.remove(handle, {.over = 0.2});
  loop.step();
  loop.run(0.1);
  BOOST_TEST(std::abs(controller.activation(handle) - 0.5) <= 1e-9);
  controller.remove(handle, {.over = 0.1});  // faster from where it is
  loop.step();
  BOOST_TEST(std::abs(controller.activation(handle) - 0.5) <= 2e-2);
  loop.run(0.11);
  BOOST_TEST(controller.activation(handle) == 0.0);
  BOOST_TEST(loop.u.norm() == 0.0);
}

BOOST_AUTO_TEST_CASE(at_once_means_at_once) {
  Loop loop(youbot(), {});
  const TaskHandle handle = loop.controller.add(1, Posture(loop.robot, Vector::Zero(8)));
  loop.step();
  BOOST_TEST(loop.controller.activation(handle) == 1.0);
  BOOST_TEST(loop.u.norm() > 0.1);
  loop.controller.remove(handle);
  loop.step();
  BOOST_TEST(loop.controller.activation(handle) == 0.0);
  BOOST_TEST(loop.u.norm() == 0.0);
}

BOOST_AUTO_TEST_CASE(handles_stay_valid_while_others_come_and_go) {
  Loop loop(youbot(), {});
  Controller& controller = loop.controller;
  const TaskHandle rest = controller.add(3, Posture(loop.robot, Vector::Zero(8)));
  const TaskHandle reach = controller.add(1, FramePosition(loop.robot, "ee", Vector3(0.5, 0.1, 0.2)));
  loop.step();
  controller.remove(rest);
  loop.step();
  const TaskHandle calm = controller.add(2, Damping(loop.robot));
  loop.step();
  BOOST_TEST(controller.task(reach).type() == "frame_position");
  BOOST_TEST(controller.task(calm).type() == "damping");
  check_error([&] { controller.task(rest); }, {"no task with handle"});
  check_error([&] { controller.remove(rest); }, {"no task with handle"});
}

BOOST_AUTO_TEST_CASE(one_law_serves_when_nothing_is_in_transition) {
  Loop loop(youbot(), {});
  loop.controller.add(1, FramePosition(loop.robot, "ee", Vector3(0.5, 0.1, 0.2)));
  loop.controller.add(2, Posture(loop.robot, Vector::Zero(8)), {.over = 0.1});
  loop.run(0.05);
  BOOST_TEST(loop.controller.status().laws == 2);
  loop.run(0.1);
  BOOST_TEST(loop.controller.status().laws == 1);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
