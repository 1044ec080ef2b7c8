#pragma once

#include <tope/controller/controller.hpp>
#include <tope/plant/mujoco.hpp>
#include <tope/plant/rigid_body.hpp>
#include <tope/robot/robot.hpp>
#include <tope/task/task.hpp>

#include <filesystem>
#include <map>
#include <memory>
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
  std::vector<std::string> notices;  ///< what was added or is worth knowing, a sentence each

  /// Bound of each joint's command (n): of its speed, or of its torque in torque mode.
  const Vector& command_bound() const;

  /// A controller as the scenario describes it, with its tasks. Errors: ConfigError when it refuses its options.
  Controller build_controller() const;

  /// Reads a file, with "--set" overrides (dotted key -> YAML value). Errors: ConfigError naming file, line
  /// and key.
  static Scenario load(const std::filesystem::path& file,
                       const std::map<std::string, std::string>& overrides = {});
};

}  // namespace tope
