#pragma once

#include <tope/controller/controller.hpp>
#include <tope/plant/mujoco.hpp>
#include <tope/plant/rigid_body.hpp>
#include <tope/robot/robot.hpp>
#include <tope/task/task.hpp>

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tope {

/// A task of a scenario: what the controller adds, and what people call it.
struct ScenarioTask {
  std::string name;
  int level = 1;
  std::shared_ptr<const Task> task;
  double tolerance = 1e-3;  ///< norm of the error below which its goal counts as reached [m or rad]
};

/// The types of tasks that a scenario can name.
std::vector<std::string> task_type_names();

/// What happens to a task of a scenario at one moment, and over the seconds after it.
struct TaskChange {
  enum class Kind { add, remove, move, replace };
  Kind kind = Kind::add;
  std::size_t task = 0;                ///< its number in Scenario::tasks
  double at = 0.0;                     ///< [s]
  double over = 0.0;                   ///< [s]
  int level = 1;                       ///< to which it moves
  std::shared_ptr<const Task> with{};  ///< what replaces it, with as many rows
};

/// When a task of a scenario is there.
struct TaskCourse {
  bool at_start = true;  ///< false for a task that is added later
  bool at_end = true;
  bool always = true;
  int lowest_level = 1;               ///< that it takes on the way
  std::optional<double> goal_time{};  ///< when the last of its references promises to arrive [s]
};

/// An upper limit that moves with constant velocity for a while.
struct MovingLimit {
  int joint = 0;
  double velocity = 0.0;  ///< [rad/s or m/s]
  double start = 0.0;     ///< [s]
  double duration = 0.0;  ///< [s]

  /// How far it has moved at time t [s].
  double moved(double t) const;
  /// Its velocity at time t [s].
  double rate(double t) const;
};

/// A complete experiment as a YAML file tells it.
struct Scenario {
  std::string name;
  std::string description;
  std::filesystem::path file;
  std::filesystem::path urdf;  ///< of the robot, absolute
  std::shared_ptr<const Robot> robot;
  ControllerOptions controller;
  std::vector<MovingLimit> moving_limits;
  std::string plant;  ///< "kinematic", "rigid_body" or "mujoco"
  RigidBodyOptions rigid_body;
  MujocoOptions
      mujoco;      ///< what the plant's own keys say; drive and wheels follow from the controller's mode
  Vector initial;  ///< q at t = 0 (nq)
  double duration = 0.0;  ///< [s]
  int log_every = 1;      ///< cycles between rows of the log
  std::vector<ScenarioTask> tasks;
  std::vector<TaskChange> changes;   ///< of the tasks, by time
  std::vector<std::string> notices;  ///< what was added or is worth knowing, a sentence each

  /// Bound of each joint's command (n): of its speed, or of its torque in torque mode.
  const Vector& command_bound() const;

  /// What the changes make of a task.
  TaskCourse course(std::size_t task) const;

  /// A controller as the scenario describes it, with the tasks of its start. Errors: ConfigError when it refuses its options.
  Controller build_controller() const;

  /// Reads a file, with "--set" overrides (dotted key -> YAML value). Errors: ConfigError naming file, line
  /// and key.
  static Scenario load(const std::filesystem::path& file,
                       const std::map<std::string, std::string>& overrides = {});
};

}  // namespace tope
