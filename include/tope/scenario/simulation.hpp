#pragma once

#include <tope/scenario/closed_loop.hpp>
#include <tope/scenario/log.hpp>
#include <tope/scenario/metrics.hpp>
#include <tope/scenario/scenario.hpp>
#include <tope/scenario/smoothness.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace tope {

struct SimulationOptions {
  std::filesystem::path log_file{};           ///< empty: none
  bool keep_log = false;                      ///< keep the rows in memory
  std::function<void(double)> on_progress{};  ///< called now and then with the share done, 0 to 1; may throw
};

/// The closed loop of a scenario: controller, plant, log and metrics.
class Simulation {
 public:
  /// Errors: ConfigError when the controller refuses its options, Error when the log cannot be written.
  Simulation(const Scenario& scenario, const SimulationOptions& options);

  /// Runs to the end of the scenario. The log has `a.<task>`, how far a task is there, for tasks that changes are about, and
  /// goes on with the errors of those that have left.
  Summary run();

  const Log& log() const { return log_; }
  /// Computing time of each cycle's Controller::update [us]. Not in the log, which is the same in every run.
  const std::vector<double>& cycle_times() const { return cycle_times_; }

 private:
  void write_row();
  void evaluate_truth();
  Summary complete(Summary summary, const Smoothness& smoothness) const;

  SimulationOptions options_;
  ClosedLoop loop_;
  Log log_;
  std::vector<double> row_;
  RobotTerms true_terms_;
  std::vector<std::unique_ptr<Task>> true_tasks_;
  std::vector<std::shared_ptr<const Task>> true_of_;  // what they are copies of
  std::vector<Vector> errors_;                        // of each task at the true state
  std::vector<double> norms_;
  std::optional<CollisionLimits> true_distances_;
  Vector least_distance_;
  std::vector<double> cycle_times_;
};

}  // namespace tope
