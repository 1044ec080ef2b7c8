#include <tope/scenario/simulation.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace tope {
namespace {

constexpr int kProgressSteps = 200;

bool has_sensors(const Scenario& scenario) { return scenario.plant == "mujoco"; }

bool changes(const Scenario& scenario, std::size_t task) {
  return std::any_of(scenario.changes.begin(), scenario.changes.end(),
                     [task](const TaskChange& change) { return change.task == task; });
}

std::vector<std::string> log_columns(const Scenario& scenario, const CollisionLimits* distances) {
  std::vector<std::string> columns{"t"};
  const std::vector<std::string>& joints = scenario.robot->joint_names();
  for (const char* quantity : {"q.", "v.", "u."}) {
    for (const std::string& joint : joints) {
      columns.push_back(quantity + joint);
    }
  }
  for (const char* side : {".upper", ".lower"}) {
    for (const std::string& joint : joints) {
      columns.push_back("xi." + joint + side);
    }
  }
  for (const ScenarioTask& task : scenario.tasks) {
    for (int i = 0; i < task.task->size(); ++i) {
      columns.push_back("e." + task.name + "." + std::to_string(i));
    }
  }
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    if (changes(scenario, i)) {
      columns.push_back("a." + scenario.tasks[i].name);
    }
  }
  if (distances) {
    for (const std::string& pair : distances->names()) {
      columns.push_back("d." + pair);
    }
  }
  columns.emplace_back("scale");
  if (scenario.robot->base()) {
    for (int i = 0; i < 4; ++i) {
      columns.push_back("wheel." + std::to_string(i));
    }
  }
  if (has_sensors(scenario)) {
    for (const std::string& joint : joints) {
      columns.push_back("measured." + joint);
    }
  }
  return columns;
}

std::vector<Metrics::TaskInfo> task_infos(const Scenario& scenario) {
  std::vector<Metrics::TaskInfo> infos;
  infos.reserve(scenario.tasks.size());
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    const ScenarioTask& task = scenario.tasks[i];
    const TaskCourse course = scenario.course(i);
    infos.push_back({.name = task.name,
                     .goal = task.task->is_goal() && course.at_end,
                     .goal_time = course.goal_time,
                     .tolerance = task.tolerance});
  }
  return infos;
}

Vector buffers(const JointLimits& limits) {
  Vector values(limits.size());
  for (int j = 0; j < limits.size(); ++j) {
    values[j] = limits.buffer(j);
  }
  return values;
}

double elapsed_us(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

Simulation::Simulation(const Scenario& scenario, const SimulationOptions& options)
    : options_(options),
      loop_(scenario),
      log_(log_columns(scenario, loop_.controller().collisions()), options.log_file, options.keep_log),
      true_terms_(*scenario.robot) {
  true_tasks_.resize(scenario.tasks.size());
  true_of_.resize(scenario.tasks.size());
  row_.reserve(log_.columns().size());
  errors_.resize(scenario.tasks.size());
  norms_.resize(scenario.tasks.size());
  if (const auto& collisions = scenario.controller.limits.collisions) {
    true_distances_.emplace(*scenario.robot, *collisions, JointLimits::default_gain,
                            JointLimitOptions{}.servo_gain);
    least_distance_ = Vector::Constant(true_distances_->size(), std::numeric_limits<double>::infinity());
  }
}

Summary Simulation::run() {
  const Scenario& scenario = loop_.scenario();
  const double dt = scenario.controller.dt;
  const auto cycles = static_cast<int>(std::lround(scenario.duration / dt));
  const int progress_every = std::max(1, cycles / kProgressSteps);
  const JointLimits& limits = loop_.controller().limits();
  Metrics metrics(limits.lower(), limits.upper(), buffers(limits), scenario.command_bound(),
                  task_infos(scenario), cycles, dt);
  Smoothness smoothness(scenario.robot->nv(), static_cast<int>(errors_.size()), cycles, dt);
  cycle_times_.reserve(static_cast<std::size_t>(cycles));
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const auto begin = std::chrono::steady_clock::now();
    const Status& status = loop_.control();
    cycle_times_.push_back(elapsed_us(begin));
    evaluate_truth();
    metrics.move_limits(limits.lower(), limits.upper());
    metrics.observe(loop_.time(), loop_.position(), loop_.command(), norms_, status, cycle_times_.back());
    smoothness.observe(loop_.velocity(), errors_);
    if (cycle % scenario.log_every == 0) {
      write_row();
    }
    loop_.move();
    if (options_.on_progress && cycle % progress_every == 0) {
      options_.on_progress(static_cast<double>(cycle) / cycles);
    }
  }
  loop_.control();  // at the state that the last command led to
  evaluate_truth();
  metrics.move_limits(limits.lower(), limits.upper());
  metrics.observe_end(loop_.time(), loop_.position(), norms_);
  smoothness.observe(loop_.velocity(), errors_);
  write_row();
  return complete(metrics.summary(), smoothness);
}

/// Errors and distances at the true state, which the controller may not see.
void Simulation::evaluate_truth() {
  true_terms_.update(loop_.position(), loop_.velocity());
  for (std::size_t i = 0; i < true_tasks_.size(); ++i) {
    if (const auto& task = loop_.scenario().tasks[i].task; task != true_of_[i]) {  // a change replaced it
      true_tasks_[i] = task->clone();
      true_of_[i] = task;
    }
    true_tasks_[i]->update(true_terms_, loop_.time());
    errors_[i] = true_tasks_[i]->error();
    norms_[i] = errors_[i].norm();
  }
  if (true_distances_) {
    true_distances_->update(true_terms_);
    least_distance_ = least_distance_.cwiseMin(true_distances_->distance());
  }
}

/// Adds what the loop knows at its end.
Summary Simulation::complete(Summary summary, const Smoothness& smoothness) const {
  const Plant& plant = loop_.plant();
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    TaskResult& result = summary.tasks[loop_.scenario().tasks[i].name];
    const Task* task = loop_.task(i);
    result.measured_error = task != nullptr ? task->error().norm() : std::numeric_limits<double>::quiet_NaN();
    result.acceleration = smoothness.acceleration(static_cast<int>(i));
  }
  summary.velocity_variation = smoothness.velocity_variation();
  summary.sensor_error = (plant.measured_position() - plant.position()).cwiseAbs();
  summary.contacts = plant.contacts();
  if (true_distances_) {
    for (int i = 0; i < true_distances_->size(); ++i) {
      summary.least_distance[true_distances_->names()[static_cast<std::size_t>(i)]] = least_distance_[i];
    }
  }
  return summary;
}

void Simulation::write_row() {
  const auto append = [this](const auto& values) { row_.insert(row_.end(), values.begin(), values.end()); };
  const Controller& controller = loop_.controller();
  row_.assign(1, loop_.time());
  append(loop_.position());
  append(loop_.velocity());
  append(loop_.command());
  append(controller.upper_activation());
  append(controller.lower_activation());
  for (const Vector& error : errors_) {
    append(error);
  }
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    if (changes(loop_.scenario(), i)) {
      row_.push_back(loop_.activation(i));
    }
  }
  if (true_distances_) {
    append(true_distances_->distance());
  }
  row_.push_back(controller.status().scale);
  if (const auto wheels = loop_.wheels()) {
    append(*wheels);
  }
  if (has_sensors(loop_.scenario())) {
    append(loop_.plant().measured_position());
  }
  log_.write(row_, event_names(controller.status()));
}

}  // namespace tope
