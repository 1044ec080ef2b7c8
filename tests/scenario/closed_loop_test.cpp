// ClosedLoop: one cycle after another, tasks that enter and leave, another reading of the scenario adopted, against a
// controller and a plant driven by hand. LiveSimulation: cycles that are due, goals followed, what it refuses. Not here:
// LiveGoal (task room); real time (test_play.py).
#include "support/no_allocation.hpp"
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/plant/kinematic.hpp>
#include <tope/robot/robot_terms.hpp>
#include <tope/scenario/live_simulation.hpp>

#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>

namespace tope::test {
namespace {

Scenario velocity_scenario(const std::map<std::string, std::string>& overrides = {}) {
  return Scenario::load(source_path("scenarios/youbot_velocity.yaml"), overrides);
}

Vector3 end_effector(const ClosedLoop& loop) {
  RobotTerms terms(*loop.scenario().robot);
  terms.update(loop.position(), loop.velocity());
  return terms.frame_position(loop.scenario().robot->frame_index("ee"));
}

void run(ClosedLoop& loop, int cycles) {
  for (int i = 0; i < cycles; ++i) {
    loop.control();
    loop.move();
  }
}

const Vector3 kNear{0.45, 0.05, 0.15};

Matrix3 goal_rotation() {
  return Eigen::Quaterniond(0.0397, 0.9811, 0.1867, -0.0322).normalized().toRotationMatrix();
}

}  // namespace

BOOST_AUTO_TEST_SUITE(closed_loop)

BOOST_AUTO_TEST_CASE(repeats_bit_for_bit) {
  for (const std::string mode : {"velocity", "torque"}) {
    for (const std::string& method : limit_method_names()) {
      BOOST_TEST_CONTEXT(mode << ", " << method) {
        const auto file = source_path("bench/cycle_" + mode + ".yaml");  // many limits act in it
        const Scenario scenario = Scenario::load(
            file, {{"limits.method", method},
                   {"limits.conditions", "report"},
                   {"limits.potential_field", "{joints: [base_x], influence: 0.1, strength: 0.2}"}});
        ClosedLoop first(scenario);
        ClosedLoop second(scenario);
        for (int cycle = 0; cycle < 1500; ++cycle) {
          first.control();
          second.control();
          BOOST_TEST_REQUIRE(std::memcmp(first.command().data(), second.command().data(),
                                         sizeof(double) * static_cast<std::size_t>(first.command().size())) ==
                             0);
          first.move();
          second.move();
        }
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(is_controller_and_plant_in_turn) {
  const Scenario scenario = velocity_scenario();
  ClosedLoop loop(scenario);
  Controller controller(*scenario.robot, scenario.controller);
  for (const ScenarioTask& task : scenario.tasks) {
    controller.add(task.level, *task.task);
  }
  Kinematic plant(*scenario.robot);
  plant.reset(scenario.initial);
  Vector u = Vector::Zero(scenario.robot->nv());
  for (int cycle = 0; cycle < 200; ++cycle) {
    controller.update(plant.position(), plant.velocity(), cycle * scenario.controller.dt, u);
    loop.control();
    BOOST_TEST((loop.command() == u));
    plant.step(u, scenario.controller.dt);
    loop.move();
    BOOST_TEST((loop.position() == plant.position()));
  }
  BOOST_TEST(std::abs(loop.time() - 0.2) <= 1e-12);
}

BOOST_AUTO_TEST_CASE(tasks_leave_and_enter_over_time) {
  ClosedLoop loop(velocity_scenario());
  run(loop, 10);
  loop.remove(1, 0.1);
  BOOST_TEST((loop.task(1) == nullptr));
  BOOST_TEST((loop.task(0) != nullptr));
  run(loop, 300);
  const Vector3 before = end_effector(loop);
  const double error = loop.task(0)->error().norm();
  loop.remove(1, 0.1);  // is not there: nothing happens
  loop.insert(1, 0.1);
  loop.insert(1, 0.1);  // is there already
  BOOST_TEST((loop.task(1) != nullptr));
  run(loop, 1000);
  BOOST_TEST((end_effector(loop) - before).norm() > 0.01);
  BOOST_TEST(loop.task(0)->error().norm() < error);
}

BOOST_AUTO_TEST_CASE(changes_are_made_when_they_are_due) {
  ClosedLoop loop(Scenario::load(source_path("scenarios/youbot_task_changes.yaml")));
  const Scenario scenario = loop.scenario();
  Controller controller(*scenario.robot, scenario.controller);  // the same by hand
  const TaskHandle orientation = controller.add(2, *scenario.tasks[0].task);
  const TaskHandle position = controller.add(3, *scenario.tasks[1].task);
  TaskHandle look;
  Vector u = Vector::Zero(8);
  for (int cycle = 0; cycle < 10000; ++cycle) {
    switch (cycle) {
      case 3000:
        controller.remove(orientation, {.over = 0.5});
        break;
      case 4000:
        look = controller.add(4, *scenario.tasks[2].task, {.over = 0.5});
        break;
      case 6000:
        controller.move(look, 1, {.over = 0.5});
        break;
      case 8000:
        controller.replace(position, *scenario.changes[3].with, {.over = 1.0});
        break;
      default:
        break;
    }
    controller.update(loop.position(), loop.velocity(), loop.time(), u);
    {
      const NoAllocation guard("cycle between changes");
      loop.control();
    }
    BOOST_TEST_REQUIRE((loop.command() == u));
    loop.move();
  }
  BOOST_TEST((loop.task(0) == nullptr));
  BOOST_TEST(loop.activation(0) == 0.0);
  BOOST_TEST(loop.activation(1) == 1.0);
  BOOST_TEST((loop.scenario().tasks[1].task == scenario.changes[3].with));
  BOOST_TEST(loop.scenario().tasks[2].level == 1);
}

BOOST_AUTO_TEST_CASE(changes_that_were_made_stay_under_another_reading) {
  const auto file = source_path("scenarios/youbot_task_changes.yaml");
  ClosedLoop loop(Scenario::load(file));
  run(loop, 8500);
  loop.adopt(Scenario::load(file, {{"limits.method", "chain"}}));
  BOOST_TEST((loop.task(0) == nullptr));
  BOOST_TEST((loop.task(2) != nullptr));
  BOOST_TEST(loop.scenario().tasks[2].level == 1);
  BOOST_TEST((loop.scenario().tasks[1].task == loop.scenario().changes[3].with));
  run(loop, 100);
}

BOOST_AUTO_TEST_CASE(goes_on_under_another_reading) {
  ClosedLoop loop(velocity_scenario());
  run(loop, 500);
  const Vector q = loop.position();
  const double t = loop.time();
  loop.remove(1, 0.0);
  loop.adopt(velocity_scenario({{"limits.method", "chain"}, {"limits.joints.base_x.upper", "0.5"}}));
  BOOST_TEST((loop.position() == q));
  BOOST_TEST(loop.time() == t);
  BOOST_TEST((loop.task(1) == nullptr));  // what was removed stays so
  BOOST_TEST((loop.controller().options().limits.method == LimitMethod::chain));
  BOOST_TEST(loop.controller().limits().upper()[0] == 0.5);
}

BOOST_AUTO_TEST_CASE(a_refused_reading_changes_nothing) {
  ClosedLoop loop(velocity_scenario());
  run(loop, 100);
  check_error([&] { loop.adopt(velocity_scenario({{"limits.gain", "5000"}})); }, {"limits are not safe"});
  BOOST_TEST(loop.controller().limits().gain(0) == 10.0);
  run(loop, 100);
  BOOST_TEST((loop.task(0) != nullptr));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(live_simulation)

BOOST_AUTO_TEST_CASE(runs_the_cycles_that_are_due) {
  LiveSimulation live(velocity_scenario());
  for (int i = 0; i < 1000; ++i) {
    live.advance(0.0004);
  }
  BOOST_TEST(std::abs(live.loop().time() - 0.4) <= 1.1e-3);
  check_error([&] { live.advance(-1.0); }, {"advance", "zero or positive"});
}

BOOST_AUTO_TEST_CASE(follows_a_goal_that_is_put_elsewhere) {
  LiveSimulation live(velocity_scenario());
  BOOST_TEST((live.goals().at("ee")->put_position() == Vector3(0.640, 0.105, 0.068)));
  live.put_goal("ee", kNear, goal_rotation());
  live.advance(6.0);
  BOOST_TEST((end_effector(live.loop()) - kNear).norm() <= 1e-3);
  check_error([&] { live.put_goal("tip", kNear, goal_rotation()); }, {"no task is about a frame 'tip'"});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  check_error([&] { live.put_goal("ee", Vector3::Constant(nan), goal_rotation()); }, {"must be finite"});
}

BOOST_AUTO_TEST_CASE(a_dragged_goal_makes_no_jump) {
  LiveSimulation live(velocity_scenario());
  live.advance(5.0);
  const Vector bound = live.loop().scenario().robot->velocity_limit();
  Vector last = live.loop().command();
  live.put_goal("ee", kNear, goal_rotation());
  double jump = 0.0;
  for (int i = 0; i < 1000; ++i) {
    live.advance(1e-3);
    jump = std::max(jump, (live.loop().command() - last).cwiseQuotient(bound).lpNorm<Eigen::Infinity>());
    last = live.loop().command();
  }
  BOOST_TEST(jump > 0.0);
  BOOST_TEST(jump < 0.05);
}

BOOST_AUTO_TEST_CASE(goals_stay_when_the_scenario_is_read_again) {
  LiveSimulation live(velocity_scenario());
  live.put_goal("ee", kNear, goal_rotation());
  live.adopt(velocity_scenario({{"tasks.1.reference.gain", "3"}}));
  live.advance(6.0);
  BOOST_TEST((end_effector(live.loop()) - kNear).norm() <= 1e-3);
  BOOST_TEST(live.loop().task(1)->gain() == 3.0);
}

BOOST_AUTO_TEST_CASE(what_a_change_brings_follows_the_goal_too) {
  LiveSimulation live(Scenario::load(source_path("scenarios/youbot_task_changes.yaml")));
  const Vector3 goal(0.45, 0.05, 0.2);
  live.advance(9.5);
  live.put_goal("ee", goal, goal_rotation());
  live.advance(6.0);
  BOOST_TEST((end_effector(live.loop()) - goal).norm() <= 2e-3);
}

BOOST_AUTO_TEST_CASE(says_what_cannot_change) {
  LiveSimulation live(velocity_scenario());
  check_error([&] { live.adopt(velocity_scenario({{"dt", "5e-4"}})); }, {"dt cannot change"});
  check_error([&] { live.adopt(velocity_scenario({{"mode", "torque"}})); }, {"mode cannot change"});
  check_error([&] { live.adopt(velocity_scenario({{"tasks.0.name", "other"}})); }, {"tasks cannot change"});
  check_error([&] { live.adopt(velocity_scenario({{"tasks.0.frame", "arm_link_5"}})); },
              {"frames of tasks cannot change"});
  check_error([&] { live.remove("positoin", 0.5); }, {"no task is named 'positoin'", "position"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
