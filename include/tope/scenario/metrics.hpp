#pragma once

#include <tope/common/types.hpp>
#include <tope/controller/status.hpp>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tope {

/// How far a task got.
struct TaskResult {
  double final_error = 0.0;            ///< norm [m or rad]
  std::optional<double> at_goal_time;  ///< norm at the time its reference promises
  double measured_error = 0.0;         ///< final norm as the robot's sensors have it; NaN: has left
  double acceleration = 0.0;           ///< root mean square over the last half of the run [m/s2 or rad/s2]
};

/// Figures of a whole run, in the units of each joint.
struct Summary {
  Vector limit_violation;  ///< largest distance beyond a limit (n); negative: distance kept; NaN: no limit
  Vector command_jump;     ///< largest change of u between cycles after the first, over the joint's bound (n)
  Vector command_variation;   ///< total variation of u over the last half of the run (n)
  Vector velocity_variation;  ///< total variation of v over the last half of the run (n)
  Vector buffer_time;         ///< seconds spent inside a buffer (n)
  Vector sensor_error;        ///< how far the sensors are from the truth at the end (n)
  std::map<std::string, TaskResult> tasks;
  std::map<std::string, double> contacts;        ///< Plant::contacts()
  std::map<std::string, double> least_distance;  ///< of each pair that is to keep its distance [m]
  std::optional<double> time_to_goal;  ///< from here on every goal's error stays below its tolerance [s]
  std::map<std::string, int> status_counts;
  std::array<double, 4> cycle_time_us{};  ///< p50, p99, p99.9, max of Controller::update
  int cycles = 0;
};

/// Collects a Summary cycle by cycle.
class Metrics {
 public:
  struct TaskInfo {
    std::string name;
    bool goal = true;                   ///< counts for time_to_goal
    std::optional<double> goal_time{};  ///< [s]
    double tolerance = 1e-3;            ///< [m or rad]
  };

  Metrics(Vector lower, Vector upper, Vector buffer, Vector bound, std::vector<TaskInfo> tasks, int cycles,
          double dt);

  /// Limits (n) of the states to come, where they move.
  void move_limits(const Vector& lower, const Vector& upper);
  /// One cycle at time t: true state q, command u, the norm of each task's error, status and the update's time.
  void observe(double t, const Vector& q, const Vector& u, const std::vector<double>& errors,
               const Status& status, double cycle_time_us);
  /// The state and errors after the last command.
  void observe_end(double t, const Vector& q, const std::vector<double>& errors);

  Summary summary() const;

 private:
  void observe_state(double t, const Vector& q, const std::vector<double>& errors);

  Vector lower_;
  Vector upper_;
  Vector buffer_;
  Vector bound_;
  std::vector<TaskInfo> tasks_;
  int planned_cycles_;
  double dt_;

  Summary summary_;
  Vector last_command_;
  std::vector<double> cycle_times_;
  std::optional<double> reached_since_;
};

}  // namespace tope
