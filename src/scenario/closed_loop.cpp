#include <tope/common/error.hpp>
#include <tope/plant/kinematic.hpp>
#include <tope/plant/mujoco.hpp>
#include <tope/scenario/closed_loop.hpp>

#include <utility>

namespace tope {
namespace {

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

}  // namespace

ClosedLoop::ClosedLoop(Scenario scenario)
    : scenario_(std::move(scenario)),
      controller_(std::make_unique<Controller>(*scenario_.robot, scenario_.controller)),
      plant_(make_plant(scenario_)),
      command_(Vector::Zero(scenario_.robot->nv())) {
  handles_.resize(scenario_.tasks.size());
  leaving_.resize(scenario_.tasks.size());
  for (std::size_t i = 0; i < handles_.size(); ++i) {
    if (scenario_.course(i).at_start) {
      insert(i, 0.0);
    }
  }
  make_due_changes();
  plant_->reset(scenario_.initial);
}

const Status& ClosedLoop::control() {
  move_limits();
  return controller_->update(plant_->measured_position(), plant_->measured_velocity(), time(), command_);
}

/// Tells the controller where the limits are, as a robot that sees the obstacle would.
void ClosedLoop::move_limits() {
  const Robot& robot = *scenario_.robot;
  for (const MovingLimit& moving : scenario_.moving_limits) {
    const LimitMotion motion{.lower = robot.position_lower()[moving.joint],
                             .upper = robot.position_upper()[moving.joint] + moving.moved(time()),
                             .upper_rate = moving.rate(time())};
    if (!controller_->move_limits(moving.joint, motion)) {
      throw Error("limits of " + robot.joint_names()[static_cast<std::size_t>(moving.joint)] + " at " +
                  std::to_string(time()) +
                  " s: the upper one comes too near the lower one for their buffers");
    }
  }
}

void ClosedLoop::move() {
  plant_->step(command_, scenario_.controller.dt);
  ++cycle_;
  make_due_changes();
}

void ClosedLoop::make_due_changes() {
  const double due = time() + 0.5 * scenario_.controller.dt;  // times are given in a few digits
  for (; next_change_ < scenario_.changes.size() && scenario_.changes[next_change_].at <= due;
       ++next_change_) {
    make(scenario_.changes[next_change_]);
  }
}

void ClosedLoop::make(const TaskChange& change) {
  ScenarioTask& task = scenario_.tasks[change.task];
  const std::optional<TaskHandle>& handle = handles_[change.task];
  forget_gone();
  switch (change.kind) {
    case TaskChange::Kind::add:
      insert(change.task, change.over);
      break;
    case TaskChange::Kind::remove:
      remove(change.task, change.over);
      break;
    case TaskChange::Kind::move:
      task.level = change.level;
      if (handle) {
        controller_->move(*handle, task.level, {.over = change.over});
      }
      break;
    case TaskChange::Kind::replace:
      task.task = change.with;
      if (handle) {
        controller_->replace(*handle, *task.task, {.over = change.over});
      }
      break;
  }
}

/// The controller forgets tasks that are gone when others come.
void ClosedLoop::forget_gone() {
  for (std::optional<TaskHandle>& handle : leaving_) {
    if (handle && controller_->activation(*handle) == 0.0) {
      handle.reset();
    }
  }
}

void ClosedLoop::adopt(Scenario scenario) {
  for (std::size_t i = 0; i < next_change_; ++i) {
    const TaskChange& made = scenario.changes[i];
    ScenarioTask& task = scenario.tasks[made.task];
    task.level = made.kind == TaskChange::Kind::move ? made.level : task.level;
    task.task = made.kind == TaskChange::Kind::replace ? made.with : task.task;
  }
  auto controller = std::make_unique<Controller>(*scenario.robot, scenario.controller);
  std::vector<std::optional<TaskHandle>> handles(handles_.size());
  for (std::size_t i = 0; i < handles.size(); ++i) {
    if (handles_[i]) {
      handles[i] = controller->add(scenario.tasks[i].level, *scenario.tasks[i].task);
    }
  }
  handles_ = std::move(handles);
  leaving_.assign(handles_.size(), std::nullopt);
  scenario_ = std::move(scenario);
  controller_ = std::move(controller);
  control();  // so that tasks, activations and status are those of the new controller
}

void ClosedLoop::insert(std::size_t task, double over) {
  if (!handles_[task]) {
    forget_gone();
    const ScenarioTask& added = scenario_.tasks[task];
    handles_[task] = controller_->add(added.level, *added.task, {.over = over});
  }
}

void ClosedLoop::remove(std::size_t task, double over) {
  std::optional<TaskHandle>& handle = handles_[task];
  if (handle) {
    controller_->remove(*handle, {.over = over});
    leaving_[task] = handle;
    handle.reset();
  }
}

double ClosedLoop::activation(std::size_t task) const {
  const std::optional<TaskHandle>& handle = handles_[task] ? handles_[task] : leaving_[task];
  return handle ? controller_->activation(*handle) : 0.0;
}

const Task* ClosedLoop::task(std::size_t task) const {
  const std::optional<TaskHandle>& handle = handles_[task];
  return handle ? &controller_->task(*handle) : nullptr;
}

std::optional<MecanumBase::Wheels> ClosedLoop::wheels() const {
  const auto& base = scenario_.robot->base();
  if (!base) {
    return std::nullopt;
  }
  const double yaw = plant_->measured_position()[base->options().joints[2]];
  if (scenario_.controller.mode == Mode::velocity) {
    return base->wheel_speeds(command_, yaw);
  }
  return base->wheel_torques(base->base_wrench(command_, yaw), scenario_.controller.wheel_distribution);
}

}  // namespace tope
