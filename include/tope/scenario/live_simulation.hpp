#pragma once

#include <tope/scenario/closed_loop.hpp>
#include <tope/task/live_goal.hpp>

#include <map>
#include <memory>
#include <string>

namespace tope {

/// A scenario that never ends and that can be changed while it runs: goals dragged, limits and options replaced, tasks
/// inserted and removed. The goals of tasks about a frame stand where they are at t = 0, until they are put elsewhere; what
/// a change of the scenario puts in a task's place follows them too.
/// For one thread.
class LiveSimulation {
 public:
  /// Errors: as ClosedLoop.
  explicit LiveSimulation(const Scenario& scenario);

  /// Runs the cycles that fit into `seconds` and what an earlier call left over.
  void advance(double seconds);

  /// Where the tasks want the frame of that name to be. Errors: Error for a frame that no task is about, or a goal
  /// that is not finite.
  void put_goal(const std::string& frame, const Vector3& position, const Matrix3& rotation);
  const std::map<std::string, std::shared_ptr<LiveGoal>>& goals() const { return goals_; }

  /// Goes on under another reading of the same scenario file. Errors: ConfigError if robot, mode, period, plant or
  /// the tasks' names differ, or the controller refuses its options; nothing is changed then.
  void adopt(const Scenario& scenario);
  /// Adds or removes the task of that name, over so many seconds. Errors: Error for an unknown name.
  void insert(const std::string& task, double over);
  void remove(const std::string& task, double over);

  const ClosedLoop& loop() const { return loop_; }

 private:
  Scenario with_live_goals(Scenario scenario) const;
  std::size_t task_index(const std::string& name) const;

  std::map<std::string, std::shared_ptr<LiveGoal>> goals_;  // by frame
  ClosedLoop loop_;
  double left_over_ = 0.0;  // [s]
};

}  // namespace tope
