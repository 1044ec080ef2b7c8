// Tasks that come, go, move between levels and are replaced: activations over time, commands that stay continuous (their
// largest jump falls with the period) in both modes, exact ends, and handles of tasks that are gone. Not here:
// orientation errors that pass pi, where a command jumps by definition and the status says so.
#include "support/jump.hpp"
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
#include <deque>
#include <functional>
#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(controller_transition)
namespace {

/// While tasks come, overlap and go.
double largest_jump(LimitMethod method, int seed, double dt) {
  Random random(seed);
  Loop loop(youbot_before_obstacle(), {.dt = dt, .limits = {.method = method}});
  const FramePosition reach(loop.robot, "ee", Vector3(0.5, 0.1, 0.2) + Vector3(random.vector(3, 0.1)));
  const FrameOrientation turn(loop.robot, "ee", random.rotation());
  const Posture rest(loop.robot, random_position(random, loop.robot, 0.3));
  Jump jump(loop);
  const auto observe = std::ref(jump);
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
  return jump.largest;
}

struct Tasks {
  Tasks(Random& random, const Robot& robot)
      : reach(robot, "ee", Vector3(0.5, 0.1, 0.2) + Vector3(random.vector(3, 0.1))),
        again(robot, "ee", Vector3(0.4, -0.1, 0.3) + Vector3(random.vector(3, 0.1))),
        turn(robot, "ee", random.rotation()),
        rest(robot, random_position(random, robot, 0.3)) {}

  FramePosition reach;
  FramePosition again;
  FrameOrientation turn;
  Posture rest;
};

/// Calls `observe` after each cycle while levels and targets change.
template <typename Observe>
void change_levels_and_targets(Loop& loop, const Tasks& tasks, Observe observe) {
  Controller& controller = loop.controller;
  const TaskHandle turn = controller.add(1, tasks.turn);
  const TaskHandle reach = controller.add(2, tasks.reach);
  controller.add(4, tasks.rest);
  loop.run(0.1, observe);
  controller.move(reach, 1, {.over = 0.2});
  controller.move(turn, 3, {.over = 0.3});
  loop.run(0.1, observe);
  controller.move(turn, 2, {.over = 0.2});  // before it has arrived
  controller.replace(reach, tasks.again, {.over = 0.2});
  loop.run(0.15, observe);
  controller.remove(turn, {.over = 0.2});  // while it moves
  loop.run(0.3, observe);
}

double largest_jump_of_changes(LimitMethod method, Mode mode, int seed, double dt) {
  Random random(seed);
  Loop loop(youbot_before_obstacle(), {.mode = mode, .dt = dt, .limits = {.method = method}});
  const Tasks tasks(random, loop.robot);
  Jump jump(loop);
  change_levels_and_targets(loop, tasks, std::ref(jump));
  return jump.largest;
}

/// Controllers of velocity mode with the tasks of `change_levels_and_targets` as they never change.
class Unchanging {
 public:
  Unchanging(const Loop& loop, const Tasks& tasks) : bound_(loop.robot.velocity_limit()) {
    for (const FramePosition* reach : {&tasks.reach, &tasks.again}) {
      for (const int reach_level : {1, 2}) {
        for (const int turn_level : {0, 1, 2, 3}) {
          Controller& controller = controllers_.emplace_back(loop.robot, loop.controller.options());
          controller.add(reach_level, *reach);
          controller.add(4, tasks.rest);
          if (turn_level > 0) {
            controller.add(turn_level, tasks.turn);
          }
        }
      }
    }
    last_.assign(controllers_.size(), Vector::Zero(bound_.size()));
  }

  /// The largest jump of any of them since the last call, over each joint's bound.
  double jump(const Loop& loop, const Vector& q) {
    double largest = 0.0;
    Vector u(bound_.size());
    for (std::size_t i = 0; i < controllers_.size(); ++i) {
      controllers_[i].update(q, loop.v, loop.t, u);
      largest = std::max(largest, (u - last_[i]).cwiseQuotient(bound_).cwiseAbs().maxCoeff());
      last_[i] = u;
    }
    return largest;
  }

 private:
  Vector bound_;
  std::deque<Controller> controllers_;
  std::vector<Vector> last_;
};

}  // namespace

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

// A slope of a law that takes less than a millisecond shows at shorter periods only; two of the 24 are that steep.
BOOST_AUTO_TEST_CASE(levels_and_targets_change_without_a_jump) {
  int steep = 0;
  for (const Mode mode : {Mode::velocity, Mode::torque}) {
    for (const LimitMethod method : {LimitMethod::unilateral, LimitMethod::chain}) {
      for (int seed = 0; seed < 6; ++seed) {
        BOOST_TEST_CONTEXT((mode == Mode::torque ? "torque " : "velocity ")
                           << to_string(method) << ", seed " << seed) {
          const double coarse = largest_jump_of_changes(method, mode, seed, 1e-3);
          const double fine = largest_jump_of_changes(method, mode, seed, 1e-4);
          BOOST_TEST_MESSAGE("ratio " << coarse / fine << ", largest jump " << coarse << " of the bound");
          if (coarse / fine >= 8.0) {
            continue;
          }
          ++steep;
          BOOST_TEST(fine / largest_jump_of_changes(method, mode, seed, 1e-5) >= 8.0);
        }
      }
    }
  }
  BOOST_TEST(steep <= 2);
}

// Where the command is steepest on the way of such a change, a law whose tasks never change is steeper still: the steep
// draws of the test above, where five joints are at bounds of their speed.
BOOST_AUTO_TEST_CASE(a_change_adds_nothing_to_a_steep_slope) {
  for (const int seed : {3, 5}) {
    for (const double dt : {1e-3, 1e-4}) {
      BOOST_TEST_CONTEXT("seed " << seed << ", period " << dt) {
        Random random(seed);
        Loop loop(youbot_before_obstacle(), {.dt = dt, .midpoint = false});
        const Tasks tasks(random, loop.robot);
        Unchanging unchanging(loop, tasks);
        Jump jump(loop);
        Vector q = loop.q;
        double alone_there = 0.0;
        change_levels_and_targets(loop, tasks, [&] {
          const double before = jump.largest;
          jump();
          const double alone = unchanging.jump(loop, q);
          alone_there = jump.largest > before ? alone : alone_there;
          q = loop.q;
        });
        BOOST_TEST_MESSAGE("largest jump " << jump.largest << ", of a law alone " << alone_there);
        BOOST_TEST(alone_there > jump.largest);
      }
    }
  }
}

// A controller that always had the tasks like this gives the same command; at the measured state, as the middle of the
// period depends on the command before.
BOOST_AUTO_TEST_CASE(both_ends_of_a_change_are_exact) {
  for (const Mode mode : {Mode::velocity, Mode::torque}) {
    for (const LimitMethod method : {LimitMethod::unilateral, LimitMethod::chain}) {
      Random random(3);
      Loop loop(youbot_before_obstacle(), {.mode = mode, .limits = {.method = method}, .midpoint = false});
      const Tasks tasks(random, loop.robot);
      const auto fresh_command = [&](int turn_level, int reach_level, const Task& reach) {
        Controller fresh(loop.robot, loop.controller.options());
        fresh.add(turn_level, tasks.turn);
        fresh.add(reach_level, reach);
        Vector expected(8);
        fresh.update(loop.q, loop.v, loop.t, expected);
        return expected;
      };
      const auto difference = [&](const Vector& expected) {
        loop.controller.update(loop.q, loop.v, loop.t, loop.u);
        return (loop.u - expected).cwiseAbs().maxCoeff();
      };
      const TaskHandle turn = loop.controller.add(1, tasks.turn);
      const TaskHandle reach = loop.controller.add(2, tasks.reach);
      loop.run(0.05);
      loop.controller.move(turn, 3, {.over = 0.1});
      loop.controller.replace(reach, tasks.again, {.over = 0.1});
      BOOST_TEST(difference(fresh_command(1, 2, tasks.reach)) <= 1e-9);
      loop.run(0.05);
      BOOST_TEST(difference(fresh_command(1, 2, tasks.reach)) > 1e-3);
      BOOST_TEST(difference(fresh_command(3, 2, tasks.again)) > 1e-3);
      loop.run(0.06);
      BOOST_TEST(difference(fresh_command(3, 2, tasks.again)) <= 1e-9);
    }
  }
}

BOOST_AUTO_TEST_CASE(only_a_task_that_stays_can_change) {
  Loop loop(youbot(), {});
  Controller& controller = loop.controller;
  const TaskHandle reach = controller.add(1, FramePosition(loop.robot, "ee", Vector3(0.5, 0.1, 0.2)));
  check_error([&] { controller.move(reach, 0); }, {"level", "at least 1", "0"});
  check_error([&] { controller.move(reach, 2, {.over = -1.0}); }, {"over", "-1"});
  check_error([&] { controller.move({42}, 2); }, {"no task with handle 42"});
  controller.replace(reach, Damping(loop.robot), {.over = 0.1});
  BOOST_TEST(controller.task(reach).type() == "damping");
  controller.remove(reach, {.over = 0.1});
  loop.step();
  check_error([&] { controller.move(reach, 2); }, {"is being removed"});
  check_error([&] { controller.replace(reach, Damping(loop.robot)); }, {"is being removed"});
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
