#include "bindings.hpp"

#include <tope/law/limit_method.hpp>
#include <tope/scenario/benchmark.hpp>
#include <tope/scenario/simulation.hpp>

#include <Eigen/Geometry>
#include <nanobind/ndarray.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/string_view.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nb = nanobind;
using namespace nb::literals;

namespace tope::python {
namespace {

nb::object finite_or_none(double value) { return std::isfinite(value) ? nb::cast(value) : nb::none(); }

nb::object optional_number(const std::optional<double>& value) {
  return value ? nb::cast(*value) : nb::none();
}

nb::dict describe_joint(const Robot& robot, const JointLimits& limits, const Vector& bound, int joint) {
  nb::dict entry;
  entry["name"] = robot.joint_names()[static_cast<std::size_t>(joint)];
  entry["unit"] = robot.joint_unit(joint);
  entry["lower"] = finite_or_none(limits.lower()[joint]);
  entry["upper"] = finite_or_none(limits.upper()[joint]);
  entry["buffer"] = limits.buffer(joint);
  entry["bound"] = finite_or_none(bound[joint]);
  return entry;
}

nb::dict describe_task(const Robot& robot, const ScenarioTask& task, const TaskCourse& course) {
  nb::dict entry;
  entry["name"] = task.name;
  entry["type"] = std::string(task.task->type());
  entry["level"] = task.level;
  entry["size"] = task.task->size();
  entry["unit"] = std::string(task.task->error_unit());
  entry["goal_time"] = optional_number(course.goal_time);
  entry["starts"] = course.at_start;
  entry["stays"] = course.at_end;
  entry["gain"] = task.task->gain();
  const auto goal = task.task->frame_goal(0.0);
  entry["frame"] = goal ? nb::cast(robot.frame_name(goal->frame)) : nb::none();
  return entry;
}

nb::dict describe_robot(const Scenario& scenario) {
  nb::dict entry;
  entry["name"] = scenario.robot->name();
  entry["urdf"] = scenario.urdf.string();
  entry["locked_joints"] = nb::cast(scenario.robot->locked_joints());
  const auto& base = scenario.robot->moving_base();
  entry["base"] = base ? nb::cast(to_string(base->type)) : nb::none();
  return entry;
}

/// Type and sizes of a shape, under the names that scenario files have for them.
nb::dict describe_shape(const Shape& shape) {
  nb::dict entry;
  if (const auto* sphere = std::get_if<shape::Sphere>(&shape)) {
    entry["type"] = "sphere";
    entry["radius"] = sphere->radius;
  } else if (const auto* box = std::get_if<shape::Box>(&shape)) {
    entry["type"] = "box";
    entry["size"] = nb::cast(std::vector<double>(box->size.begin(), box->size.end()));
  } else if (const auto* capsule = std::get_if<shape::Capsule>(&shape)) {
    entry["type"] = "capsule";
    entry["radius"] = capsule->radius;
    entry["length"] = capsule->length;
  } else if (const auto* cylinder = std::get_if<shape::Cylinder>(&shape)) {
    entry["type"] = "cylinder";
    entry["radius"] = cylinder->radius;
    entry["length"] = cylinder->length;
  } else {
    entry["type"] = std::holds_alternative<shape::HalfSpace>(shape) ? "half_space" : "convex_hull";
  }
  return entry;
}

/// The bodies that the world carries.
nb::list describe_obstacles(const CollisionOptions& collisions) {
  nb::list obstacles;
  for (const CollisionBody& body : collisions.geometry.bodies) {
    if (!body.frame.empty()) {
      continue;
    }
    nb::dict entry = describe_shape(body.shape);
    const Eigen::Quaterniond turn(body.rotation);
    entry["name"] = body.name;
    entry["position"] = nb::cast(std::vector<double>(body.position.begin(), body.position.end()));
    entry["quaternion"] = nb::cast(std::vector<double>{turn.w(), turn.x(), turn.y(), turn.z()});
    obstacles.append(entry);
  }
  return obstacles;
}

nb::dict describe_scenario(const Scenario& scenario) {
  const JointLimits limits(*scenario.robot, scenario.controller.limits.rows);
  nb::list joints;
  for (int j = 0; j < scenario.robot->nv(); ++j) {
    joints.append(describe_joint(*scenario.robot, limits, scenario.command_bound(), j));
  }
  nb::list tasks;
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    tasks.append(describe_task(*scenario.robot, scenario.tasks[i], scenario.course(i)));
  }
  nb::dict entry;
  entry["name"] = scenario.name;
  entry["description"] = scenario.description;
  entry["file"] = scenario.file.string();
  entry["mode"] = scenario.controller.mode == Mode::torque ? "torque" : "velocity";
  entry["plant"] = scenario.plant;
  entry["method"] = to_string(scenario.controller.limits.method);
  entry["dt"] = scenario.controller.dt;
  entry["duration"] = scenario.duration;
  entry["robot"] = describe_robot(scenario);
  entry["joints"] = joints;
  entry["tasks"] = tasks;
  entry["notices"] = nb::cast(scenario.notices);
  if (const auto& collisions = scenario.controller.limits.collisions) {
    const CollisionLimits distances(*scenario.robot, *collisions, limits.least_gain(),
                                    limits.options().servo_gain);
    entry["distances"] = nb::cast(distances.names());
    entry["obstacles"] = describe_obstacles(*collisions);
  }
  return entry;
}

/// {joint: value, "overall": largest of value / scale}; joints whose value is NaN are left out.
nb::dict by_joint(const Robot& robot, const Vector& values, const Vector& scale) {
  nb::dict entry;
  double overall = -std::numeric_limits<double>::infinity();
  for (int j = 0; j < robot.nv(); ++j) {
    if (std::isnan(values[j])) {
      continue;
    }
    entry[robot.joint_names()[static_cast<std::size_t>(j)].c_str()] = values[j];
    overall = std::max(overall, values[j] / scale[j]);
  }
  entry["overall"] = finite_or_none(overall);
  return entry;
}

/// {pair: distance, "overall": the least}.
nb::dict by_pair(const std::map<std::string, double>& distances) {
  nb::dict entry;
  double overall = std::numeric_limits<double>::infinity();
  for (const auto& [pair, distance] : distances) {
    entry[pair.c_str()] = distance;
    overall = std::min(overall, distance);
  }
  entry["overall"] = overall;
  return entry;
}

nb::dict describe_summary(const Scenario& scenario, const Summary& summary) {
  const Robot& robot = *scenario.robot;
  const Vector ones = Vector::Ones(robot.nv());
  nb::dict errors;
  for (const auto& [name, result] : summary.tasks) {
    nb::dict error;
    error["final"] = result.final_error;
    error["at_goal_time"] = optional_number(result.at_goal_time);
    error["measured"] = finite_or_none(result.measured_error);
    error["acceleration"] = result.acceleration;
    errors[name.c_str()] = error;
  }
  nb::dict cycle_time;
  const std::array<const char*, 4> names{"p50", "p99", "p999", "max"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    cycle_time[names[i]] = summary.cycle_time_us[i];
  }
  nb::dict entry;
  entry["scenario"] = describe_scenario(scenario);
  entry["max_limit_violation"] = by_joint(robot, summary.limit_violation, ones);
  entry["max_command_jump"] = by_joint(robot, summary.command_jump, ones);
  entry["command_variation"] = by_joint(robot, summary.command_variation, scenario.command_bound());
  entry["velocity_variation"] = by_joint(robot, summary.velocity_variation, robot.velocity_limit());
  entry["sensor_error"] = by_joint(robot, summary.sensor_error, ones);
  entry["contacts"] = nb::cast(summary.contacts);
  if (!summary.least_distance.empty()) {
    entry["least_distance"] = by_pair(summary.least_distance);
  }
  entry["buffer_time"] = by_joint(robot, summary.buffer_time, ones);
  entry["task_error"] = errors;
  entry["time_to_goal"] = optional_number(summary.time_to_goal);
  entry["status_counts"] = nb::cast(summary.status_counts);
  entry["cycle_time_us"] = cycle_time;
  entry["cycles"] = summary.cycles;
  entry["completed"] = true;
  return entry;
}

/// Rows of the log as a numpy array that owns a copy.
nb::object log_array(const Log& log) {
  auto* copy = new std::vector<double>(log.values());
  const nb::capsule owner(copy,
                          [](void* pointer) noexcept { delete static_cast<std::vector<double>*>(pointer); });
  const std::size_t columns = log.columns().size();
  return nb::cast(
      nb::ndarray<nb::numpy, double, nb::ndim<2>>(copy->data(), {copy->size() / columns, columns}, owner));
}

nb::dict simulate(const Scenario& scenario, const std::optional<std::filesystem::path>& out,
                  const std::optional<std::function<void(double)>>& progress, bool keep_log) {
  Simulation simulation(scenario, {.log_file = out ? *out / "log.csv" : std::filesystem::path(),
                                   .keep_log = keep_log,
                                   .on_progress = progress ? *progress : std::function<void(double)>()});
  const Summary summary = simulation.run();
  nb::dict result;
  result["summary"] = describe_summary(scenario, summary);
  result["columns"] = nb::cast(simulation.log().columns());
  result["data"] = log_array(simulation.log());
  result["status"] = nb::cast(simulation.log().status());
  result["cycle_time_us"] = nb::cast(simulation.cycle_times());
  return result;
}

nb::dict time_cycles(const Scenario& scenario, int acting, int cycles) {
  const Benchmark timed = benchmark(scenario, {.cycles = cycles, .acting = acting});
  nb::dict entry;
  entry["states"] = timed.states;
  entry["largest_laws"] = timed.largest_laws;
  entry["cycle_us"] = nb::cast(timed.cycle_us);
  entry["rigid_body_us"] = nb::cast(timed.rigid_body_us);
  entry["idle_us"] = nb::cast(timed.idle_us);
  return entry;
}

nb::list check(const Scenario& scenario) {
  ControllerOptions options = scenario.controller;
  options.limits.enforce_conditions = false;
  nb::list list;
  for (const Condition& condition : Controller(*scenario.robot, options).conditions()) {
    nb::dict entry;
    entry["name"] = condition.name;
    entry["joint"] = condition.joint;
    entry["expression"] = condition.expression;
    entry["value"] = condition.value;
    entry["bound"] = condition.bound;
    entry["margin"] = condition.margin();
    entry["ok"] = condition.holds();
    entry["advice"] = condition.advice;
    list.append(entry);
  }
  return list;
}

}  // namespace

void bind_simulation(nb::module_& module) {
  module.attr("LIMIT_METHODS") = nb::tuple(nb::cast(limit_method_names()));
  nb::class_<Scenario>(module, "Scenario", "A complete experiment as a YAML file tells it.")
      .def("describe", &describe_scenario)
      .def(
          "controller", [](const Scenario& scenario) { return new Controller(scenario.build_controller()); },
          nb::rv_policy::take_ownership, "A controller as the scenario describes it, with its tasks.")
      .def_prop_ro("initial", [](const Scenario& scenario) -> Vector { return scenario.initial; });
  module.def("load_scenario", &Scenario::load, "path"_a,
             "overrides"_a = std::map<std::string, std::string>{});
  module.def("simulate", &simulate, "scenario"_a, "out"_a = nb::none(), "progress"_a = nb::none(),
             "keep_log"_a = true);
  module.def("check", &check, "scenario"_a);
  module.def("benchmark", &time_cycles, "scenario"_a, "acting"_a = -1,
             "cycles"_a = BenchmarkOptions{}.cycles);
}

}  // namespace tope::python
