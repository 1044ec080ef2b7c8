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
};

/// Figures of a whole run, in the units of each joint.
struct Summary {
  Vector limit_violation;  ///< largest distance beyond a limit (n); negative: distance kept; NaN: no limit
  Vector command_jump;     ///< largest change of u between cycles after the first, over the joint's bound (n)
  Vector command_variation;  ///< total variation of u over the last half of the run (n)
  Vector buffer_time;        ///< seconds spent inside a buffer (n)
  std::map<std::string, TaskResult> tasks;
  std::optional<double> time_to_goal;  ///< from here on every goal's error stays below 1 mm and 1 mrad [s]
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
  };

  Metrics(Vector lower, Vector upper, Vector buffer, Vector bound, std::vector<TaskInfo> tasks, int cycles,
          double dt);

  /// One cycle at time t: state q, command u, the norm of each task's error, status and the update's time.
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
