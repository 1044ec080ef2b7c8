#include <tope/plant/kinematic.hpp>
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

std::unique_ptr<Plant> make_plant(const Scenario& scenario) {
  if (scenario.plant == "rigid_body") {
    return std::make_unique<RigidBody>(*scenario.robot, scenario.rigid_body, scenario.controller.dt);
  }
  return std::make_unique<Kinematic>(*scenario.robot);
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
    : scenario_(scenario),
      options_(options),
      controller_(*scenario.robot, scenario.controller),
      plant_(make_plant(scenario)),
      log_(log_columns(scenario), options.log_file, options.keep_log) {
  for (const ScenarioTask& task : scenario_.tasks) {
    handles_.push_back(controller_.add(task.level, *task.task));
  }
  row_.reserve(log_.columns().size());
  errors_.resize(scenario_.tasks.size());
}

Summary Simulation::run() {
  const double dt = scenario_.controller.dt;
  const auto cycles = static_cast<int>(std::lround(scenario_.duration / dt));
  const int progress_every = std::max(1, cycles / kProgressSteps);
  const JointLimits& limits = controller_.limits();
  Metrics metrics(limits.lower(), limits.upper(), buffers(limits), scenario_.command_bound(),
                  task_infos(scenario_), cycles, dt);
  plant_->reset(scenario_.initial);
  Vector u = Vector::Zero(scenario_.robot->nv());
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const double t = cycle * dt;
    const auto begin = std::chrono::steady_clock::now();
    controller_.update(plant_->position(), plant_->velocity(), t, u);
    const double cycle_time = elapsed_us(begin);
    evaluate_errors();
    metrics.observe(t, plant_->position(), u, errors_, controller_.status(), cycle_time);
    if (cycle % scenario_.log_every == 0) {
      write_row(t, u);
    }
    plant_->step(u, dt);
    if (options_.on_progress && cycle % progress_every == 0) {
      options_.on_progress(static_cast<double>(cycle) / cycles);
    }
  }
  // the state that the last command led to
  controller_.update(plant_->position(), plant_->velocity(), cycles * dt, u);
  evaluate_errors();
  metrics.observe_end(cycles * dt, plant_->position(), errors_);
  write_row(cycles * dt, u);
  return metrics.summary();
}

void Simulation::evaluate_errors() {
  for (std::size_t i = 0; i < handles_.size(); ++i) {
    errors_[i] = controller_.task(handles_[i]).error().norm();
  }
}

/// Speeds [rad/s] or torques [Nm] of the wheels under the command u.
MecanumBase::Wheels Simulation::wheel_commands(const MecanumBase& base, const Vector& u) const {
  const double yaw = plant_->position()[base.options().joints[2]];
  if (scenario_.controller.mode == Mode::velocity) {
    return base.wheel_speeds(u, yaw);
  }
  const Eigen::Vector3d wrench = base.base_wrench(u, yaw);
  return scenario_.controller.wheel_distribution == WheelDistribution::minimum_peak
             ? base.minimum_peak_torques(wrench)
             : base.minimum_norm_torques(wrench);
}

void Simulation::write_row(double t, const Vector& u) {
  const auto append = [this](const auto& values) { row_.insert(row_.end(), values.begin(), values.end()); };
  row_.assign(1, t);
  append(plant_->position());
  append(plant_->velocity());
  append(u);
  append(controller_.upper_activation());
  append(controller_.lower_activation());
  for (const TaskHandle handle : handles_) {
    append(controller_.task(handle).error());
  }
  row_.push_back(controller_.status().scale);
  if (const auto& base = scenario_.robot->base()) {
    append(wheel_commands(*base, u));
  }
  log_.write(row_, event_names(controller_.status()));
}

}  // namespace tope
