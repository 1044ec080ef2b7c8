#include <tope/scenario/simulation.hpp>

#include <chrono>
#include <cmath>

namespace tope {
namespace {

constexpr int kProgressSteps = 200;

std::vector<std::string> log_columns(const Scenario& scenario) {
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
  columns.emplace_back("scale");
  if (scenario.robot->base()) {
    for (int i = 0; i < 4; ++i) {
      columns.push_back("wheel." + std::to_string(i));
    }
  }
  return columns;
}

std::vector<Metrics::TaskInfo> task_infos(const Scenario& scenario) {
  std::vector<Metrics::TaskInfo> infos;
  infos.reserve(scenario.tasks.size());
  for (const ScenarioTask& task : scenario.tasks) {
    infos.push_back({.name = task.name, .goal = task.task->is_goal(), .goal_time = task.task->duration()});
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
    : options_(options), loop_(scenario), log_(log_columns(scenario), options.log_file, options.keep_log) {
  row_.reserve(log_.columns().size());
  errors_.resize(scenario.tasks.size());
}

Summary Simulation::run() {
  const Scenario& scenario = loop_.scenario();
  const double dt = scenario.controller.dt;
  const auto cycles = static_cast<int>(std::lround(scenario.duration / dt));
  const int progress_every = std::max(1, cycles / kProgressSteps);
  const JointLimits& limits = loop_.controller().limits();
  Metrics metrics(limits.lower(), limits.upper(), buffers(limits), scenario.command_bound(),
                  task_infos(scenario), cycles, dt);
  cycle_times_.reserve(static_cast<std::size_t>(cycles));
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const auto begin = std::chrono::steady_clock::now();
    const Status& status = loop_.control();
    cycle_times_.push_back(elapsed_us(begin));
    evaluate_errors();
    metrics.observe(loop_.time(), loop_.position(), loop_.command(), errors_, status, cycle_times_.back());
    if (cycle % scenario.log_every == 0) {
      write_row();
    }
    loop_.move();
    if (options_.on_progress && cycle % progress_every == 0) {
      options_.on_progress(static_cast<double>(cycle) / cycles);
    }
  }
  loop_.control();  // at the state that the last command led to
  evaluate_errors();
  metrics.observe_end(loop_.time(), loop_.position(), errors_);
  write_row();
  return metrics.summary();
}

void Simulation::evaluate_errors() {
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    errors_[i] = loop_.task(i)->error().norm();
  }
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
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    append(loop_.task(i)->error());
  }
  row_.push_back(controller.status().scale);
  if (const auto wheels = loop_.wheels()) {
    append(*wheels);
  }
  log_.write(row_, event_names(controller.status()));
}

}  // namespace tope
