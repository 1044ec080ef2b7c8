// Simulation: a short run's log and summary, bit for bit repeatable; sensors; limits that move. Metrics: their figures on made-up
// cycles. Log: rows in memory and in the file. Not here: whether the controller does well; report and
// command line.
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/scenario/simulation.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace tope::test {
namespace {

Scenario short_scenario() {
  return Scenario::load(source_path("scenarios/youbot_velocity.yaml"), {{"duration", "0.2"}});
}

Vector one(double value) { return Vector::Constant(1, value); }

Metrics one_joint_metrics(int cycles) {
  return Metrics(one(-1.0), one(1.0), one(0.1), one(2.0),
                 {{.name = "reach", .goal = true, .goal_time = 0.2}, {.name = "rest", .goal = false}}, cycles,
                 0.1);
}

}  // namespace

BOOST_AUTO_TEST_SUITE(simulation)

BOOST_AUTO_TEST_CASE(logs_every_cycle_and_the_end) {
  const Scenario scenario = short_scenario();
  Simulation simulation(scenario, {.keep_log = true});
  const Summary summary = simulation.run();
  const Log& log = simulation.log();
  const std::size_t cycles = static_cast<std::size_t>(std::lround(0.2 / scenario.controller.dt));
  BOOST_TEST(summary.cycles == static_cast<int>(cycles));
  BOOST_TEST(log.status().size() == cycles + 1);
  BOOST_TEST(log.values().size() == (cycles + 1) * (log.columns().size()));
  BOOST_TEST(log.columns()[0] == "t");
  BOOST_TEST(log.columns()[1] == "q.base_x");
  BOOST_TEST(std::count(log.columns().begin(), log.columns().end(), "xi.arm_joint_5.upper") == 1);
  BOOST_TEST(log.values()[log.columns().size()] == scenario.controller.dt);
  BOOST_TEST(summary.limit_violation.head(2).maxCoeff() <= 0.0);
  BOOST_TEST(std::isnan(summary.limit_violation[2]));  // yaw has no limit
}

BOOST_AUTO_TEST_CASE(measured_and_true_state_are_told_apart) {
  const Scenario scenario = Scenario::load(source_path("scenarios/youbot_experiment_velocity.yaml"),
                                           {{"duration", "0.5"}, {"plant.sensors.localisation", "odometry"}});
  Simulation simulation(scenario, {.keep_log = true});
  const Summary summary = simulation.run();
  const std::vector<std::string>& columns = simulation.log().columns();
  const auto last = [&](const std::string& name) {
    const auto place = std::find(columns.begin(), columns.end(), name) - columns.begin();
    return *(simulation.log().values().end() - static_cast<std::ptrdiff_t>(columns.size()) + place);
  };
  const double drift = last("measured.base_y") - last("q.base_y");
  BOOST_TEST(std::abs(drift) > 1e-3);  // the rollers' loss sideways
  BOOST_TEST(std::abs(drift) == summary.sensor_error[1]);
  BOOST_TEST(summary.tasks.at("position").measured_error != summary.tasks.at("position").final_error);
  const double norm =
      std::hypot(last("e.position.0"), last("e.position.1"), last("e.position.2"));  // of the true state
  BOOST_TEST(std::abs(norm - summary.tasks.at("position").final_error) <= 1e-12);
}

BOOST_AUTO_TEST_CASE(moving_limits_reach_the_controller_and_the_summary) {
  const Scenario scenario = Scenario::load(
      source_path("scenarios/youbot_velocity.yaml"),
      {{"duration", "3.0"},
       {"limits.joints.base_x", "{upper: 0.35, upper_motion: {velocity: -0.1, at: 1.0, for: 1.5}}"}});
  Simulation simulation(scenario, {.keep_log = true});
  const Summary summary = simulation.run();
  const double end =
      *(simulation.log().values().end() - static_cast<std::ptrdiff_t>(simulation.log().columns().size()) + 1);
  BOOST_TEST(end <= 0.2);  // q.base_x
  BOOST_TEST(end >= 0.19);
  BOOST_TEST(summary.limit_violation[0] <= 0.0);
  BOOST_TEST(summary.limit_violation[0] >= -2e-3);
}

BOOST_AUTO_TEST_CASE(limits_that_meet_stop_the_run) {
  const Scenario scenario =
      Scenario::load(source_path("scenarios/youbot_velocity.yaml"),
                     {{"duration", "1.0"},
                      {"limits.joints.base_x",
                       "{lower: 0.1, upper: 0.35, upper_motion: {velocity: -0.3, at: 0.0, for: 1.0}}"}});
  Simulation simulation(scenario, {});
  check_error([&] { simulation.run(); }, {"limits of base_x at 0.1", "too near"});
}

BOOST_AUTO_TEST_CASE(changes_of_tasks_are_logged_and_make_no_jump) {
  const Scenario scenario = Scenario::load(source_path("scenarios/youbot_task_changes.yaml"));
  Simulation simulation(scenario, {.keep_log = true});
  const Summary summary = simulation.run();
  const std::vector<std::string>& columns = simulation.log().columns();
  const auto at = [&](double t, const std::string& name) {
    const auto place =
        static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
    const auto row = static_cast<std::size_t>(std::lround(t / scenario.controller.dt));
    return simulation.log().values()[row * columns.size() + place];
  };
  const auto error = [&](double t, const std::string& task) {
    return std::hypot(at(t, "e." + task + ".0"), at(t, "e." + task + ".1"),
                      task == "look" ? 0.0 : at(t, "e." + task + ".2"));
  };
  // orientation leaves, look enters
  BOOST_TEST(at(3.0, "a.orientation") == 1.0);
  BOOST_TEST(std::abs(at(3.25, "a.orientation") - 0.5) < 1e-2);
  BOOST_TEST(at(3.6, "a.orientation") == 0.0);
  BOOST_TEST(at(12.0, "a.orientation") == 0.0);
  BOOST_TEST(at(3.9, "a.look") == 0.0);
  BOOST_TEST(at(5.0, "a.look") == 1.0);
  // and looks as soon as it may; the position's error is measured against what replaced it
  BOOST_TEST(error(2.9, "orientation") < 1e-2);
  BOOST_TEST(error(12.9, "look") < 1e-3);
  BOOST_TEST(error(7.9, "position") < 5e-3);
  BOOST_TEST(error(12.9, "position") < 5e-3);
  BOOST_TEST(std::isnan(summary.tasks.at("orientation").measured_error));
  BOOST_TEST(summary.limit_violation.head(2).maxCoeff() <= 0.0);
  Simulation finer(Scenario::load(scenario.file, {{"dt", "2.5e-4"}}), {});
  BOOST_TEST(summary.command_jump.maxCoeff() > 3.8 * finer.run().command_jump.maxCoeff());  // none is a jump
  BOOST_TEST(summary.time_to_goal.has_value());  // of those that stay
}

BOOST_AUTO_TEST_CASE(repeats_bit_for_bit) {
  const auto values = [] {
    Simulation simulation(short_scenario(), {.keep_log = true});
    simulation.run();
    return simulation.log().values();
  };
  BOOST_TEST((values() == values()));
}

BOOST_AUTO_TEST_CASE(writes_the_log_to_its_file) {
  const TemporaryFile file("log.csv", "");
  {
    Log log({"t", "x"}, file.path(), true);
    log.write(std::vector<double>{0.0, 0.5}, "ok");
    log.write(std::vector<double>{0.1, -1.25}, "limit|scaled");
    BOOST_TEST(log.values()[3] == -1.25);
    BOOST_TEST(log.status()[1] == "limit|scaled");
  }
  BOOST_TEST(read_text(file.path()) == "t,x,status\n0,0.5,ok\n0.1,-1.25,limit|scaled\n");
  check_error([] { Log({"t"}, "/no/such/folder/log.csv", false); },
              {"cannot write", "/no/such/folder/log.csv"});
}

BOOST_AUTO_TEST_CASE(tells_its_progress) {
  std::vector<double> progress;
  Simulation simulation(short_scenario(), {.on_progress = [&](double share) { progress.push_back(share); }});
  simulation.run();
  BOOST_TEST(progress.size() > 10U);
  BOOST_TEST(std::is_sorted(progress.begin(), progress.end()));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(metrics)

BOOST_AUTO_TEST_CASE(figures_are_those_of_the_cycles) {
  Metrics metrics = one_joint_metrics(4);
  Status fine;
  Status limited;
  limited.add(Event::limit);
  metrics.observe(0.0, one(0.0), one(2.0), {1.0, 1.0}, fine, 5.0);  // the first command is no jump
  metrics.observe(0.1, one(0.95), one(1.0), {0.5, 1.0}, limited, 7.0);
  metrics.observe(0.2, one(1.02), one(-0.5), {1e-4, 1.0}, limited, 6.0);
  metrics.observe(0.3, one(0.5), one(0.0), {2e-4, 1.0}, fine, 50.0);
  metrics.observe_end(0.4, one(0.4), {3e-4, 1.0});
  const Summary summary = metrics.summary();
  BOOST_TEST(std::abs(summary.limit_violation[0] - 0.02) <= 1e-12);
  BOOST_TEST(summary.command_jump[0] == 0.75);
  BOOST_TEST(summary.command_variation[0] == 2.0);  // of the last two cycles
  BOOST_TEST(std::abs(summary.buffer_time[0] - 0.2) <= 1e-12);
  BOOST_TEST(summary.status_counts.at("ok") == 2);
  BOOST_TEST(summary.status_counts.at("limit") == 2);
  BOOST_TEST(summary.tasks.at("reach").final_error == 3e-4);
  BOOST_TEST(*summary.tasks.at("reach").at_goal_time == 1e-4);
  BOOST_TEST(!summary.tasks.at("rest").at_goal_time.has_value());
  BOOST_TEST(*summary.time_to_goal == 0.2);
  BOOST_TEST(summary.cycle_time_us[3] == 50.0);
  BOOST_TEST(summary.cycles == 4);
}

BOOST_AUTO_TEST_CASE(a_goal_that_is_left_again_is_not_reached) {
  Metrics metrics = one_joint_metrics(2);
  metrics.observe(0.0, one(0.0), one(0.0), {1e-4, 1.0}, {}, 1.0);
  metrics.observe(0.1, one(0.0), one(0.0), {1e-2, 1.0}, {}, 1.0);
  metrics.observe_end(0.2, one(0.0), {1e-2, 1.0});
  BOOST_TEST(!metrics.summary().time_to_goal.has_value());
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
