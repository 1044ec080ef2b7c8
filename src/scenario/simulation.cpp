#include <tope/common/error.hpp>
#include <tope/plant/kinematic.hpp>
#include <tope/plant/mujoco.hpp>
#include <tope/scenario/simulation.hpp>

#include <chrono>
#include <cmath>

namespace tope {
namespace {

constexpr int kProgressSteps = 200;

bool has_sensors(const Scenario& scenario) { return scenario.plant == "mujoco"; }

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
  if (has_sensors(scenario)) {
    for (const std::string& joint : joints) {
      columns.push_back("measured." + joint);
    }
  }
  return columns;
}

std::unique_ptr<Plant> make_plant(const Scenario& scenario) {
  if (scenario.plant == "rigid_body") {
    return std::make_unique<RigidBody>(*scenario.robot, scenario.rigid_body, scenario.controller.dt);
  }
  if (scenario.plant == "mujoco") {
    MujocoOptions options = scenario.mujoco;
    options.drive = scenario.controller.mode == Mode::torque ? MujocoOptions::Drive::torque
                                                             : MujocoOptions::Drive::velocity;
    options.wheel_distribution = scenario.controller.wheel_distribution;
    return std::make_unique<Mujoco>(*scenario.robot, options, scenario.controller.dt);
  }
  return std::make_unique<Kinematic>(*scenario.robot);
}

std::vector<Metrics::TaskInfo> task_infos(const Scenario& scenario) {
  std::vector<Metrics::TaskInfo> infos;
  infos.reserve(scenario.tasks.size());
  for (const ScenarioTask& task : scenario.tasks) {
    infos.push_back({.name = task.name,
                     .goal = task.task->is_goal(),
                     .goal_time = task.task->duration(),
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
    : scenario_(scenario),
      options_(options),
      controller_(*scenario.robot, scenario.controller),
      plant_(make_plant(scenario)),
      log_(log_columns(scenario), options.log_file, options.keep_log),
      true_terms_(*scenario.robot) {
  for (const ScenarioTask& task : scenario_.tasks) {
    handles_.push_back(controller_.add(task.level, *task.task));
    true_tasks_.push_back(task.task->clone());
  }
  row_.reserve(log_.columns().size());
  errors_.resize(scenario_.tasks.size());
  norms_.resize(scenario_.tasks.size());
}

Summary Simulation::run() {
  const double dt = scenario_.controller.dt;
  const auto cycles = static_cast<int>(std::lround(scenario_.duration / dt));
  const int progress_every = std::max(1, cycles / kProgressSteps);
  const JointLimits& limits = controller_.limits();
  Metrics metrics(limits.lower(), limits.upper(), buffers(limits), scenario_.command_bound(),
                  task_infos(scenario_), cycles, dt);
  Smoothness smoothness(scenario_.robot->nv(), static_cast<int>(handles_.size()), cycles, dt);
  plant_->reset(scenario_.initial);
  Vector u = Vector::Zero(scenario_.robot->nv());
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const double t = cycle * dt;
    move_limits(t, metrics);
    const auto begin = std::chrono::steady_clock::now();
    controller_.update(plant_->measured_position(), plant_->measured_velocity(), t, u);
    const double cycle_time = elapsed_us(begin);
    evaluate_errors(t);
    metrics.observe(t, plant_->position(), u, norms_, controller_.status(), cycle_time);
    smoothness.observe(plant_->velocity(), errors_);
    if (cycle % scenario_.log_every == 0) {
      write_row(t, u);
    }
    plant_->step(u, dt);
    if (options_.on_progress && cycle % progress_every == 0) {
      options_.on_progress(static_cast<double>(cycle) / cycles);
    }
  }
  // the state that the last command led to
  move_limits(cycles * dt, metrics);
  controller_.update(plant_->measured_position(), plant_->measured_velocity(), cycles * dt, u);
  evaluate_errors(cycles * dt);
  metrics.observe_end(cycles * dt, plant_->position(), norms_);
  smoothness.observe(plant_->velocity(), errors_);
  write_row(cycles * dt, u);
  return complete(metrics.summary(), smoothness);
}

/// Tells the controller where the limits are, as a robot that sees the obstacle would.
void Simulation::move_limits(double t, Metrics& metrics) {
  const Robot& robot = *scenario_.robot;
  for (const MovingLimit& moving : scenario_.moving_limits) {
    const LimitMotion motion{.lower = robot.position_lower()[moving.joint],
                             .upper = robot.position_upper()[moving.joint] + moving.moved(t),
                             .upper_rate = moving.rate(t)};
    if (!controller_.move_limits(moving.joint, motion)) {
      throw Error("limits of " + robot.joint_names()[static_cast<std::size_t>(moving.joint)] + " at " +
                  std::to_string(t) + " s: the upper one comes too near the lower one for their buffers");
    }
  }
  metrics.move_limits(controller_.limits().lower(), controller_.limits().upper());
}

void Simulation::evaluate_errors(double t) {
  true_terms_.update(plant_->position(), plant_->velocity());
  for (std::size_t i = 0; i < true_tasks_.size(); ++i) {
    true_tasks_[i]->update(true_terms_, t);
    errors_[i] = true_tasks_[i]->error();
    norms_[i] = errors_[i].norm();
  }
}

/// Adds what the loop knows at its end.
Summary Simulation::complete(Summary summary, const Smoothness& smoothness) const {
  for (std::size_t i = 0; i < handles_.size(); ++i) {
    TaskResult& result = summary.tasks[scenario_.tasks[i].name];
    result.measured_error = controller_.task(handles_[i]).error().norm();
    result.acceleration = smoothness.acceleration(static_cast<int>(i));
  }
  summary.velocity_variation = smoothness.velocity_variation();
  summary.sensor_error = (plant_->measured_position() - plant_->position()).cwiseAbs();
  summary.contacts = plant_->contacts();
  return summary;
}

/// Speeds [rad/s] or torques [Nm] of the wheels under the command u.
MecanumBase::Wheels Simulation::wheel_commands(const MecanumBase& base, const Vector& u) const {
  const double yaw = plant_->measured_position()[base.options().joints[2]];
  if (scenario_.controller.mode == Mode::velocity) {
    return base.wheel_speeds(u, yaw);
  }
  return base.wheel_torques(base.base_wrench(u, yaw), scenario_.controller.wheel_distribution);
}

void Simulation::write_row(double t, const Vector& u) {
  const auto append = [this](const auto& values) { row_.insert(row_.end(), values.begin(), values.end()); };
  row_.assign(1, t);
  append(plant_->position());
  append(plant_->velocity());
  append(u);
  append(controller_.upper_activation());
  append(controller_.lower_activation());
  for (const Vector& error : errors_) {
    append(error);
  }
  row_.push_back(controller_.status().scale);
  if (const auto& base = scenario_.robot->base()) {
    append(wheel_commands(*base, u));
  }
  if (has_sensors(scenario_)) {
    append(plant_->measured_position());
  }
  log_.write(row_, event_names(controller_.status()));
}

}  // namespace tope
