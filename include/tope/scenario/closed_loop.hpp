#pragma once

#include <tope/controller/controller.hpp>
#include <tope/plant/plant.hpp>
#include <tope/scenario/scenario.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace tope {

/// Controller and plant of a scenario, one cycle at a time: what every way to run a scenario shares.
class ClosedLoop {
 public:
  /// Starts at the scenario's initial state, at rest, with the tasks of its start.
  /// Errors: ConfigError when the controller refuses its options.
  explicit ClosedLoop(Scenario scenario);

  /// Updates the controller at the present time, at the state that the robot's sensors see, with limits that move where
  /// they are by now. Errors: Error where moving limits come too near each other.
  const Status& control();
  /// Moves the plant on by one period under the last command; then makes the scenario's changes of tasks that are due,
  /// which may allocate.
  void move();

  /// Goes on under the options, limits and tasks of `scenario`, from the present state and time. The robot, the mode,
  /// the period, the plant and the numbers of tasks and changes must be the same; tasks that were removed stay so, and
  /// changes that were made are not made again.
  /// Errors: as the constructor; nothing is changed then.
  void adopt(Scenario scenario);
  /// Adds a task of the scenario that is not present, or removes one that is; a smooth change over `over` seconds.
  void insert(std::size_t task, double over);
  void remove(std::size_t task, double over);

  double time() const { return static_cast<double>(cycle_) * scenario_.controller.dt; }  ///< [s]
  const Vector& position() const { return plant_->position(); }                          ///< true q (nq)
  const Vector& velocity() const { return plant_->velocity(); }                          ///< true v (nv)
  const Vector& command() const { return command_; }                                     ///< last u (nv)
  /// The task as the controller last saw it; none if it is not present.
  const Task* task(std::size_t task) const;
  /// How far the task is there, 0 to 1, as it enters, leaves, or the last of its changes is carried out.
  double activation(std::size_t task) const;
  /// Speeds [rad/s] or torques [Nm] of the wheels under the last command, for a base that has them.
  std::optional<MecanumBase::Wheels> wheels() const;

  /// With the levels and tasks that the changes made so far have left.
  const Scenario& scenario() const { return scenario_; }
  const Controller& controller() const { return *controller_; }
  const Plant& plant() const { return *plant_; }

 private:
  void move_limits();
  void make_due_changes();
  void make(const TaskChange& change);
  void forget_gone();

  Scenario scenario_;
  std::unique_ptr<Controller> controller_;
  std::vector<std::optional<TaskHandle>> handles_;  // of the scenario's tasks
  std::vector<std::optional<TaskHandle>> leaving_;  // of those that fade out
  std::size_t next_change_ = 0;
  std::unique_ptr<Plant> plant_;
  Vector command_;
  std::int64_t cycle_ = 0;
};

}  // namespace tope
