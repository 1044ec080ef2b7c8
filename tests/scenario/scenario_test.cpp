// Scenario files: what they set, every way they are refused (file, line, key and suggestion in the
// message), overrides, and that the shipped ones load. Not here: what a run of them does (simulation_test).
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/scenario/scenario.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(scenario)
namespace {

/// Line numbers in the tests count from the line of `name`.
std::string good_scenario() {
  const std::string text = R"(name: test
dt: 0.002
duration: 0.1
robot:
  urdf: FOLDER/youbot.urdf
  config: FOLDER/youbot.yaml
initial: {arm_joint_2: 0.4, arm_joint_3: 0.9, arm_joint_4: 0.6}
limits:
  method: chain
  buffer: 0.12
  joints:
    base_x: {upper: 0.35, buffer: 0.2}
tasks:
  - name: turn
    type: frame_orientation
    level: 1
    frame: ee
    target: {quaternion: [1, 0, 0, 0]}
    reference: {type: predefined_time, duration: 2.0, gain: 3.0}
  - name: reach
    type: frame_position
    level: 2
    frame: ee
    target: {position: [0.5, 0.1, 0.1]}
mode: velocity
)";
  const std::string folder = source_path("robots/youbot").string();
  return replaced(replaced(text, "FOLDER", folder), "FOLDER", folder);
}

void check_refused(const std::string& from, const std::string& to, std::initializer_list<std::string> parts) {
  BOOST_TEST_CONTEXT(from << " -> " << to) {
    const TemporaryFile file("scenario.yaml", replaced(good_scenario(), from, to));
    check_error([&] { Scenario::load(file.path()); }, parts);
  }
}

void check_override_refused(const std::map<std::string, std::string>& overrides,
                            std::initializer_list<std::string> parts) {
  const TemporaryFile file("scenario.yaml", good_scenario());
  check_error([&] { Scenario::load(file.path(), overrides); }, parts);
}

}  // namespace

BOOST_AUTO_TEST_CASE(sets_what_it_says) {
  const TemporaryFile file("scenario.yaml", good_scenario());
  const Scenario scenario = Scenario::load(file.path());
  BOOST_TEST(scenario.name == "test");
  BOOST_TEST(scenario.controller.dt == 0.002);
  BOOST_TEST(scenario.duration == 0.1);
  BOOST_TEST((scenario.controller.limits.method == LimitMethod::chain));
  BOOST_TEST(scenario.controller.limits.rows.buffer == 0.12);
  BOOST_TEST(scenario.controller.limits.rows.buffers.at("base_x") == 0.2);
  BOOST_TEST(scenario.robot->position_upper()[0] == 0.35);
  BOOST_TEST(scenario.initial[4] == 0.4);
  BOOST_TEST(scenario.initial[7] == 0.0);
  BOOST_TEST(scenario.tasks.size() == 2U);
  BOOST_TEST(scenario.tasks[0].name == "turn");
  BOOST_TEST(scenario.tasks[1].level == 2);
  BOOST_TEST(scenario.tasks[0].task->type() == "frame_orientation");
  BOOST_TEST(*scenario.tasks[0].task->duration() == 2.0);
}

BOOST_AUTO_TEST_CASE(shipped_scenarios_load) {
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source_path("scenarios"))) {
    if (entry.path().extension() == ".yaml") {
      BOOST_TEST_CONTEXT(entry.path()) { BOOST_CHECK_NO_THROW(Scenario::load(entry.path())); }
      ++count;
    }
  }
  BOOST_TEST(count >= 1);
}

BOOST_AUTO_TEST_CASE(wrong_keys_are_refused_with_line_and_suggestion) {
  check_refused("name: test\n", "nmae: test\n",
                {"scenario.yaml:1: nmae: unknown key", "did you mean 'name'?"});
  check_refused("method: chain", "methd: chain", {"scenario.yaml:9: limits.methd: unknown key", "'method'?"});
  check_refused("{upper: 0.35", "{uper: 0.35", {"scenario.yaml:12: limits.joints.base_x.uper", "'upper'?"});
  check_refused("frame: ee\n    target: {pos", "frame: ee\n    colour: red\n    target: {pos",
                {"scenario.yaml:24: tasks.1.colour: unknown key"});
  check_refused(", gain: 3.0}", ", gain: 3.0, gian: 3.0}",
                {":19: tasks.0.reference.gian", "did you mean 'gain'?"});
  check_refused("  config:", "  confg:", {"scenario.yaml:6: robot.confg: unknown key", "'config'?"});
}

BOOST_AUTO_TEST_CASE(misspelled_keys_that_are_needed_are_named_too) {
  check_refused("dt: 0.002", "dtt: 0.002", {"scenario.yaml:2: dtt", "did you mean 'dt'?"});
  check_refused("duration: 0.1", "durations: 0.1",
                {"scenario.yaml:3: durations", "did you mean 'duration'?"});
  check_refused("robot:", "robots:", {"scenario.yaml:4: robots", "did you mean 'robot'?"});
  check_refused("    frame: ee", "    fram: ee", {"scenario.yaml:17: tasks.0.fram", "did you mean 'frame'?"});
  check_refused(
      "quaternion:", "quaternoin:", {"scenario.yaml:18: tasks.0.target.quaternoin", "'quaternion'?"});
}

BOOST_AUTO_TEST_CASE(missing_keys_are_named) {
  check_refused("dt: 0.002\n", "", {"scenario.yaml", "dt: is missing"});
  check_refused("    level: 2\n", "", {"scenario.yaml:20: tasks.1.level: is missing"});
  check_refused("duration: 0.1", "duration:", {"duration: is missing"});
}

BOOST_AUTO_TEST_CASE(wrong_values_are_refused) {
  check_refused("dt: 0.002", "dt: -0.002", {"scenario.yaml:2: dt: must be positive, got '-0.002'"});
  check_refused("dt: 0.002", "dt: fast", {"scenario.yaml:2: dt: expected a number, got 'fast'"});
  check_refused("dt: 0.002", "dt: .nan", {"scenario.yaml:2: dt", "finite"});
  check_refused("dt: 0.002", "dt: [1]", {"scenario.yaml:2: dt: expected a number, got a list or a map"});
  check_refused("duration: 0.1", "duration: 0.001", {"scenario.yaml:3: duration: must be at least dt"});
  check_refused("method: chain", "method: chian",
                {":9: limits.method", "unknown limit method 'chian'", "'chain'?"});
  check_refused("buffer: 0.12", "buffer: -0.12", {"scenario.yaml:10: limits.buffer: must be positive"});
  check_refused(
      "    base_x:", "    base_z:", {":12: limits.joints.base_z", "unknown joint 'base_z'", "'base_x'?"});
  check_refused("upper: 0.35", "upper: -60",
                {"scenario.yaml:12: limits.joints.base_x", "must be below upper"});
  check_refused("gain: 3.0", "gain: -3.0", {"scenario.yaml:19: tasks.0.reference.gain: must be positive"});
  check_refused("type: predefined_time", "type: predefined",
                {":19: tasks.0.reference.type", "unknown reference"});
  check_refused("type: frame_position", "type: frame_positon",
                {":21: tasks.1.type", "unknown task", "'frame_position'?"});
  check_refused("level: 2", "level: 0", {"scenario.yaml:22: tasks.1.level: must be at least 1"});
  check_refused("level: 2", "level: 1.5",
                {"scenario.yaml:22: tasks.1.level: expected a whole number, got '1.5'"});
  check_refused("frame: ee", "frame: eee",
                {"scenario.yaml:17: tasks.0.frame", "unknown frame 'eee'", "'ee'?"});
  check_refused("[1, 0, 0, 0]", "[2, 0, 0, 0]", {":18: tasks.0.target.quaternion: not a rotation", "2.0"});
  check_refused("[1, 0, 0, 0]", "[1, 0, 0]", {":18: tasks.0.target.quaternion: expected 4 numbers, got 3"});
  check_refused("[0.5, 0.1, 0.1]", "[0.5, .inf, 0.1]",
                {"scenario.yaml:24: tasks.1.target.position", "not finite"});
  check_refused("name: reach", "name: turn",
                {"scenario.yaml:20: tasks.1.name: a second task is named 'turn'"});
  check_refused("initial: {arm_joint_2", "initial: {arm_joint_6",
                {"scenario.yaml:7: initial.arm_joint_6", "unknown key"});
  check_refused("name: test\n", "name: test\nmode: speed\n",
                {"scenario.yaml:2: mode: unknown value 'speed'"});
  check_refused("youbot.urdf", "youbt.urdf", {"youbt.urdf: no such URDF file"});
  check_refused("youbot.yaml", "youbt.yaml", {"youbt.yaml: no such file"});
}

BOOST_AUTO_TEST_CASE(tasks_point_move_the_centre_of_mass_and_keep_rows) {
  const std::string old =
      "type: frame_position\n    level: 2\n    frame: ee\n    target: {position: [0.5, 0.1, 0.1]}";
  const auto tasks_of = [&](const std::string& task) {
    const TemporaryFile file("scenario.yaml", replaced(good_scenario(), old, task));
    return Scenario::load(file.path()).tasks;
  };
  const std::string pointing =
      "type: pointing\n    level: 2\n    frame: ee\n    axis: [0, 0, 1]\n    target: {position: [5, 1, 1]}";
  const std::string com =
      "type: center_of_mass\n    level: 2\n    target: {position: [0, 0, 0.1]}\n    rows: [0, 1]";
  BOOST_TEST(tasks_of(pointing)[1].task->type() == "pointing");
  BOOST_TEST(tasks_of(com)[1].task->type() == "center_of_mass");
  BOOST_TEST(tasks_of(com)[1].task->size() == 2);
  check_refused(old, replaced(pointing, "[0, 0, 1]", "[0, 0, 0]"),
                {":24: tasks.1.axis: Pointing: axis", "must not be zero"});
  check_refused(old, replaced(com, "[0, 1]", "[0, 3]"), {":24: tasks.1.rows", "row 3", "rows 0 to 2"});
  check_refused(old, replaced(com, "[0, 1]", "[0, 0]"), {":24: tasks.1.rows", "row 0 is named twice"});
  check_refused(old, replaced(com, "[0, 1]", "[0.5]"), {":24: tasks.1.rows: expected whole numbers"});
}

/// Task 1 of the good scenario, and what may stand in its place.
const std::string kReach =
    "type: frame_position\n    level: 2\n    frame: ee\n    target: {position: [0.5, 0.1, 0.1]}";

std::shared_ptr<const Task> second_task(const std::string& task) {
  const TemporaryFile file("scenario.yaml", replaced(good_scenario(), kReach, task));
  return Scenario::load(file.path()).tasks[1].task;
}

BOOST_AUTO_TEST_CASE(relative_poses_take_what_they_are_given) {
  const std::string relative =
      "type: relative_pose\n    level: 2\n    frame: ee\n    seen_from: base_link\n    target: ";
  BOOST_TEST(second_task(relative + "{position: [0.3, 0, 0.2]}")->error_unit() == "m");
  BOOST_TEST(
      second_task(relative + "{quaternion: [1, 0, 0, 0], angular_velocity: [0, 0, 1]}")->error_unit() ==
      "rad");
  BOOST_TEST(second_task(relative + "{position: [0.3, 0, 0.2], quaternion: [1, 0, 0, 0]}")->size() == 6);
  BOOST_TEST(
      second_task(relative + "{waypoints: [{at: 0, position: [0, 0, 0]}, {at: 1, position: [1, 0, 0]}]}")
          ->size() == 3);
  check_refused(kReach, relative + "{}", {":25: tasks.1.target: RelativePose: target: names neither"});
  check_refused(kReach, relative + "{position: [0, 0, 0], angular_velocity: [0, 0, 1]}",
                {":25: tasks.1.target.angular_velocity: unknown key"});
  check_refused(kReach, replaced(relative + "{position: [0, 0, 0]}", "base_link", "base_lnk"),
                {":24: tasks.1.seen_from", "unknown frame 'base_lnk'", "'base_link'?"});
}

BOOST_AUTO_TEST_CASE(manipulability_says_of_what) {
  const std::string raise = "type: manipulability\n    level: 2\n    frame: ee\n    target: 0.05";
  const std::string of =
      raise + "\n    of: {rows: [0, 1, 2], joints: [arm_joint_2, arm_joint_3, arm_joint_4]}";
  BOOST_TEST(second_task(raise)->size() == 1);
  BOOST_TEST(second_task(raise)->type() == "manipulability");
  BOOST_TEST(!second_task(raise)->is_goal());
  check_refused(kReach, of, {":25: tasks.1.of: Manipulability: the joints cannot move frame 'ee'"});
  check_refused(kReach, replaced(of, "[0, 1, 2]", "[0, 1, 7]"),
                {":25: tasks.1.of: Manipulability: rows", "7"});
  check_refused(kReach, replaced(of, "[0, 1, 2]", "[0, 1, 0.5]"), {":25: tasks.1.of.rows: expected whole"});
  check_refused(kReach, replaced(raise, "0.05", "-1"), {":24: tasks.1.target: must be positive"});
}

BOOST_AUTO_TEST_CASE(any_task_may_have_a_group_of_joints) {
  const std::string arm = kReach + "\n    joints: [arm_joint_1, arm_joint_2, arm_joint_3]";
  const auto task = second_task(arm);
  BOOST_TEST(task->type() == "frame_position");
  BOOST_TEST(task->size() == 3);
  BOOST_TEST(second_task(arm + "\n    rows: [2]")->size() == 1);
  check_refused(kReach, replaced(arm, "arm_joint_3", "arm_joint_9"),
                {":25: tasks.1.joints: unknown joint 'arm_joint_9'"});
  check_refused(kReach, kReach + "\n    joints: [base_x]",
                {":25: tasks.1.joints: JointGroup: no joint of the group moves row 1 of frame_position"});
}

BOOST_AUTO_TEST_CASE(targets_pass_waypoints) {
  const auto goal = [](const std::string& type, const std::string& waypoints, double t) {
    return *second_task("type: " + type + "\n    level: 2\n    frame: ee\n    target: {waypoints: [" +
                        waypoints + "]}")
                ->frame_goal(t);
  };
  const std::string points =
      "{at: 0, position: [0, 0, 0]}, {at: 1, position: [1, 2, 3]}, {at: 3, position: [1, 0, 0]}";
  BOOST_TEST((goal("frame_position", points, 1.0).position->array() == Vector3(1.0, 2.0, 3.0).array()).all());
  const std::string poses =
      "{at: 0, position: [0, 0, 0], quaternion: [1, 0, 0, 0]}, {at: 1, position: [1, 2, 3], quaternion: "
      "[0.707107, 0, 0, 0.707107]}";
  BOOST_TEST((goal("frame_pose", poses, 2.0).position->array() == Vector3(1.0, 2.0, 3.0).array()).all());
  BOOST_TEST((goal("frame_pose", poses, 2.0).rotation->col(0) - Vector3::UnitY()).norm() <= 1e-6);
  const auto refused = [](const std::string& waypoints, std::initializer_list<std::string> parts) {
    check_refused(kReach, replaced(kReach, "position: [0.5, 0.1, 0.1]", "waypoints: " + waypoints), parts);
  };
  refused("[{at: 0, position: [0, 0, 0]}]", {":24: tasks.1.target.waypoints: expected at least 2 waypoints"});
  refused("[{at: 1, position: [0, 0, 0]}, {at: 1, position: [0, 0, 1]}]",
          {":24: tasks.1.target.waypoints: waypoint 1: its time", "later"});
  refused("[{position: [0, 0, 0]}, {at: 1, position: [0, 0, 1]}]",
          {":24: tasks.1.target.waypoints.0.at: is missing"});
  refused("[{at: 0, position: [0, 0, 0]}, {at: 1, position: [0, 0, 1], quaternion: [1, 0, 0, 0]}]",
          {":24: tasks.1.target.waypoints.1.quaternion: unknown key"});
  refused("[{at: 0, position: [0, 0, 0]}, {at: 1, position: [0, 0, 1]}], velocity: [1, 0, 0]",
          {":24: tasks.1.target.velocity: unknown key"});
}

BOOST_AUTO_TEST_CASE(every_type_and_key_of_tasks_is_documented) {
  const std::string page = read_text(source_path("docs/tasks.md"));
  BOOST_TEST(task_type_names().size() >= 10U);
  for (const std::string& type : task_type_names()) {
    BOOST_TEST(page.find("| `" + type + "` (") != std::string::npos, type);
  }
  for (const char* key : {"rows:", "joints:", "waypoints:", "velocity:", "amplitude:", "frequency:",
                          "angular_velocity:", "seen_from", "add:", "remove:", "move:", "replace:"}) {
    BOOST_TEST(page.find(key) != std::string::npos, key);
  }
}

std::string with_changes(const std::string& changes) { return good_scenario() + "changes:\n" + changes; }

void check_changes_refused(const std::string& changes, std::initializer_list<std::string> parts) {
  BOOST_TEST_CONTEXT(changes) {
    const TemporaryFile file("scenario.yaml", with_changes(changes));
    check_error([&] { Scenario::load(file.path()); }, parts);
  }
}

BOOST_AUTO_TEST_CASE(changes_of_tasks_are_read) {
  const TemporaryFile file("scenario.yaml",
                           with_changes("  - {at: 0.5, remove: turn}\n"
                                        "  - {at: 1, add: reach, over: 0.2}\n"
                                        "  - {at: 1, move: reach, level: 5}\n"
                                        "  - {at: 2, replace: reach, with: {type: frame_position, frame: ee, "
                                        "target: {position: [0, 0, 1]}, "
                                        "reference: {type: predefined_time, duration: 3, gain: 2}}}\n"));
  const Scenario scenario = Scenario::load(file.path());
  BOOST_TEST(scenario.changes.size() == 4U);
  BOOST_TEST((scenario.changes[0].kind == TaskChange::Kind::remove));
  BOOST_TEST(scenario.changes[1].task == 1U);
  BOOST_TEST(scenario.changes[1].over == 0.2);
  BOOST_TEST(scenario.changes[2].level == 5);
  BOOST_TEST((*scenario.changes[3].with->frame_goal(0.0)->position == Vector3::UnitZ()));
  const TaskCourse turn = scenario.course(0);
  BOOST_TEST((turn.at_start && !turn.at_end && !turn.always));
  BOOST_TEST(!turn.goal_time.has_value());  // it leaves
  const TaskCourse reach = scenario.course(1);
  BOOST_TEST((!reach.at_start && reach.at_end && !reach.always));
  BOOST_TEST(*reach.goal_time == 5.0);
  BOOST_TEST(reach.lowest_level == 5);
  check_error([&] { scenario.build_controller().task({1}); },
              {"no task with handle 1"});  // the start has one task
}

BOOST_AUTO_TEST_CASE(a_task_that_leaves_does_not_take_the_freedom_that_is_left) {
  const std::string posture = replaced(
      replaced(good_scenario(), kReach, "type: posture\n    level: 2\n    target: [0, 0, 0, 0, 0, 0, 0, 0]"),
      "mode: velocity", "mode: torque");
  const TemporaryFile stays("scenario.yaml", posture);
  BOOST_TEST(Scenario::load(stays.path()).tasks.size() == 2U);
  const TemporaryFile leaves("scenario.yaml", posture + "changes: [{at: 1, remove: reach}]\n");
  BOOST_TEST(Scenario::load(leaves.path()).tasks.back().name == "damping");
  const TemporaryFile sinks("scenario.yaml", replaced(good_scenario(), "mode: velocity", "mode: torque") +
                                                 "changes: [{at: 1, move: turn, level: 7}]\n");
  BOOST_TEST(Scenario::load(sinks.path()).tasks.back().level == 8);
}

BOOST_AUTO_TEST_CASE(changes_that_make_no_sense_are_refused) {
  check_changes_refused("  - {at: 1, over: 2}\n",
                        {"scenario.yaml:27: changes.0: says no change", "add, remove"});
  check_changes_refused("  - {at: 1, add: turn, remove: reach}\n",
                        {"scenario.yaml:27: changes.0.remove: is one change, and add another"});
  check_changes_refused("  - {at: 1, remove: trun}\n",
                        {"scenario.yaml:27: changes.0.remove: no task is named 'trun'", "'turn'?"});
  check_changes_refused("  - {remove: turn}\n", {"changes.0.at: is missing"});
  check_changes_refused("  - {at: -1, remove: turn}\n",
                        {"scenario.yaml:27: changes.0.at: must not be negative"});
  check_changes_refused("  - {at: 1, remove: turn, over: -1}\n", {"changes.0.over: must not be negative"});
  check_changes_refused("  - {at: 1, remove: turn, level: 2}\n", {"changes.0.level: unknown key"});
  check_changes_refused("  - {at: 1, move: turn}\n", {"changes.0.level: is missing"});
  check_changes_refused("  - {at: 1, move: turn, level: 0}\n", {"changes.0.level: must be at least 1"});
  check_changes_refused("  - {at: 1, remove: turn}\n  - {at: 0.5, remove: reach}\n",
                        {"scenario.yaml:28: changes.1.at: is before the change above it"});
  check_changes_refused("  - {at: 1, remove: turn}\n  - {at: 2, move: turn, level: 1}\n",
                        {"scenario.yaml:28: changes.1.move: the task was removed before"});
  check_changes_refused("  - {at: 1, move: turn, level: 1}\n  - {at: 2, add: turn}\n",
                        {"scenario.yaml:28: changes.1.add: the task is there already"});
  const std::string with =
      "  - at: 1\n    replace: reach\n    with:\n      type: frame_position\n      frame: ee\n";
  check_changes_refused(with + "      target: {position: [0, 0]}\n",
                        {"scenario.yaml:32: changes.0.with.target.position: expected 3 numbers"});
  check_changes_refused(with + "      target: {position: [0, 0, 0]}\n      level: 2\n",
                        {"scenario.yaml:33: changes.0.with.level: unknown key"});
  check_changes_refused(with + "      target: {position: [0, 0, 0]}\n      rows: [1]\n",
                        {"changes.0.with: has 1 rows, task 'reach' has 3"});
}

BOOST_AUTO_TEST_CASE(limit_servo_takes_one_pair_of_gains) {
  const TemporaryFile file("scenario.yaml",
                           replaced(good_scenario(), "buffer: 0.12", "lambda_p: 80\n  lambda_v: 24"));
  const JointLimitOptions& rows = Scenario::load(file.path()).controller.limits.rows;
  BOOST_TEST(rows.gain.value() == 4.0, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(rows.servo_gain == 20.0, boost::test_tools::tolerance(1e-12));
  check_refused(
      "buffer: 0.12", "lambda_p: 80\n  lambda_v: 10",
      {"scenario.yaml:11: limits.lambda_v: limits: lambda_v^2 < 4 lambda_p", "raise lambda_v to at least"});
  check_refused("buffer: 0.12", "lambda_p: 80", {"limits.lambda_v: is missing"});
  check_refused("buffer: 0.12", "lambda_p: 80\n  lambda_v: 24\n  gain: 3",
                {"scenario.yaml:12: limits.gain", "one pair or the other"});
}

BOOST_AUTO_TEST_CASE(smoothing_is_read_or_refused) {
  const TemporaryFile file("scenario.yaml", replaced(good_scenario(), "buffer: 0.12",
                                                     "unilateral: {smoothing: {solutions: 5, spread: 4}}"));
  const auto smoothing = Scenario::load(file.path()).controller.limits.unilateral.smoothing;
  BOOST_TEST(smoothing->solutions == 5);
  BOOST_TEST(smoothing->spread == 4.0);
  check_refused("buffer: 0.12", "unilateral: {smoothing: {solutions: 1}}",
                {"scenario.yaml:10: limits.unilateral.smoothing.solutions", "must be from 2 to 16, got 1"});
  check_refused("buffer: 0.12", "unilateral: {smoothing: {width: 1}}", {"scenario.yaml:10:", "width"});
}

BOOST_AUTO_TEST_CASE(wrong_models_and_unsafe_measures_are_said) {
  const std::string torque = replaced(good_scenario(), "mode: velocity", "mode: torque");
  const TemporaryFile file("scenario.yaml", torque);
  const auto notices = [&](const std::map<std::string, std::string>& overrides) {
    std::string all;
    for (const std::string& notice : Scenario::load(file.path(), overrides).notices) {
      all += notice + "\n";
    }
    return all;
  };
  BOOST_TEST(notices({}).find("believes") == std::string::npos);
  const std::string said = notices({{"plant.payload", "0.5"},
                                    {"plant.delay", "0.002"},
                                    {"plant.friction", "true"},
                                    {"plant.inertia_scale", "0.8"},
                                    {"plant.torque_noise", "0.01"}});
  BOOST_TEST(
      said.find("links 0.8 times as heavy, 0.5 kg at ee, commands 2 ms late, friction in the joints, torque "
                "noise of 1 % of the effort.") != std::string::npos,
      said);
  BOOST_TEST(notices({{"limits.measure", "position"}}).find("overshoot") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(files_that_are_no_scenario_are_refused) {
  check_error([] { Scenario::load("/no/such/scenario.yaml"); }, {"/no/such/scenario.yaml: no such file"});
  const TemporaryFile broken("scenario.yaml", "a: 1\nb: [1, 2\nc: 3\n");
  check_error([&] { Scenario::load(broken.path()); }, {"scenario.yaml:", "not YAML"});
  const TemporaryFile empty("scenario.yaml", "");
  check_error([&] { Scenario::load(empty.path()); }, {"scenario.yaml: expected a map of keys"});
}

BOOST_AUTO_TEST_CASE(mujoco_plants_are_read_and_refused) {
  const std::string model = source_path("robots/youbot/youbot_rollers.xml").string();
  const auto with_plant = [&](const std::string& keys) {
    return good_scenario() + "plant: {type: mujoco, model: " + model + ", " + keys + "}\n";
  };
  const TemporaryFile good(
      "scenario.yaml",
      with_plant(
          "sensors: {localisation: odometry, encoder_noise: 1.0e-3, latency: 0.004}, faults: {lost_grip: "
          "{wheel: back_left, at: 1.0, for: 0.5}, payload: {mass: 0.5, at: 2.0}}"));
  const Scenario scenario = Scenario::load(good.path());
  BOOST_TEST(scenario.plant == "mujoco");
  BOOST_TEST((scenario.mujoco.sensors.localisation == SensorOptions::Localisation::odometry));
  BOOST_TEST(scenario.mujoco.sensors.encoder_noise == 1e-3);
  BOOST_TEST(scenario.mujoco.sensors.latency == 4e-3);
  BOOST_TEST(scenario.mujoco.faults.lost_grip_wheel == 2);
  BOOST_TEST(scenario.mujoco.faults.lost_grip.contains(1.4));
  BOOST_TEST(!scenario.mujoco.faults.lost_grip.contains(1.6));
  BOOST_TEST(scenario.mujoco.faults.payload.contains(1e6));
  BOOST_TEST(!scenario.mujoco.faults.stall.contains(0.0));

  const auto refused = [&](const std::string& keys, std::initializer_list<std::string> parts) {
    const TemporaryFile file("scenario.yaml", with_plant(keys));
    check_error([&] { Scenario::load(file.path()); }, parts);
  };
  refused("sensor: {}", {"scenario.yaml:26: plant.sensor: unknown key", "'sensors'?"});
  refused("sensors: {localisation: gps}", {"plant.sensors.localisation: unknown value 'gps'", "odometry"});
  refused("sensors: {encoder_noise: -1}", {"plant.sensors.encoder_noise: must not be negative"});
  refused("faults: {stal: {at: 1}}", {"plant.faults.stal: unknown key", "'stall'?"});
  refused("faults: {stall: {at: 1, for: 0}}", {"plant.faults.stall.for: must be positive"});
  refused("faults: {stall: {for: 1}}", {"plant.faults.stall.at: is missing"});
  refused("faults: {lost_grip: {wheel: left, at: 1}}", {"plant.faults.lost_grip.wheel", "front_left"});
  refused("faults: {payload: {mass: -1, at: 1}}", {"plant.faults.payload.mass: must be positive"});
  check_refused("mode: velocity", "mode: velocity\nplant: {type: mujoco, model: none.xml}",
                {"plant.model: ", "none.xml: no such file"});
  check_refused("mode: velocity", "mode: velocity\nplant: {type: rigid_body}",
                {"plant.type: 'rigid_body' does not follow", "'kinematic' or 'mujoco'"});
}

BOOST_AUTO_TEST_CASE(moving_limits_and_tolerances_are_read) {
  const TemporaryFile file(
      "scenario.yaml", replaced(replaced(good_scenario(), "{upper: 0.35, buffer: 0.2}",
                                         "{upper: 0.35, upper_motion: {velocity: -0.1, at: 2.0, for: 1.5}}"),
                                "target: {position: [0.5, 0.1, 0.1]}",
                                "target: {position: [0.5, 0.1, 0.1]}\n    tolerance: 0.005"));
  const Scenario scenario = Scenario::load(file.path());
  BOOST_TEST(scenario.tasks[0].tolerance == 1e-3);
  BOOST_TEST(scenario.tasks[1].tolerance == 5e-3);
  const MovingLimit& moving = scenario.moving_limits.at(0);
  BOOST_TEST(moving.joint == 0);
  BOOST_TEST(moving.moved(2.0) == 0.0);
  BOOST_TEST(std::abs(moving.moved(2.5) + 0.05) <= 1e-12);
  BOOST_TEST(std::abs(moving.moved(9.0) + 0.15) <= 1e-12);
  BOOST_TEST(moving.rate(1.9) == 0.0);
  BOOST_TEST(moving.rate(2.1) == -0.1);
  check_refused("{upper: 0.35, buffer", "{upper: 0.35, upper_motion: {at: 1, for: 1}, buffer",
                {"limits.joints.base_x.upper_motion.velocity: is missing"});
  check_refused("{upper: 0.35, buffer", "{upper: 0.35, upper_motion: {velocity: -0.5, at: 1, for: 1}, buffer",
                {"base_x.upper_motion.velocity: must be below half of the speed bound, 0.4", "-0.5"});
  check_refused("level: 2", "level: 2\n    tolerance: 0", {"tasks.1.tolerance: must be positive"});
}

BOOST_AUTO_TEST_CASE(overrides_apply) {
  const TemporaryFile file("scenario.yaml", good_scenario());
  const Scenario scenario =
      Scenario::load(file.path(), {{"dt", "0.001"},
                                   {"limits.method", "switch"},
                                   {"limits.joints.base_x.upper", "0.5"},
                                   {"tasks.reach.level", "3"},
                                   {"tasks.0.reference", "{type: exponential, gain: 1.0}"}});
  BOOST_TEST(scenario.controller.dt == 0.001);
  BOOST_TEST((scenario.controller.limits.method == LimitMethod::switching));
  BOOST_TEST(scenario.robot->position_upper()[0] == 0.5);
  BOOST_TEST(scenario.tasks[1].level == 3);
  BOOST_TEST(!scenario.tasks[0].task->duration().has_value());
}

BOOST_AUTO_TEST_CASE(wrong_overrides_are_named) {
  check_override_refused({{"dt", "-1"}}, {"--set dt=-1: dt: must be positive"});
  check_override_refused({{"limits.methd", "chain"}},
                         {"--set limits.methd=chain", "unknown key", "'method'?"});
  check_override_refused({{"tasks.grasp.level", "1"}}, {"--set tasks.grasp.level", "'grasp'"});
  check_override_refused({{"dt.x", "1"}}, {"--set dt.x", "single value"});
  check_override_refused({{"dt", "[1"}}, {"--set dt", "not YAML"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
