#pragma once

#include <tope/task/wrapped_task.hpp>

#include <memory>
#include <vector>

namespace tope {

/// Another task with some of its rows alone, in the order named: e = S e', where S holds rows of the identity. The height
/// of a frame, for example, is row 2 of its position; the others are free.
class SelectedRows final : public WrappedTask {
 public:
  /// Rows count from 0. Errors: ConfigError for no row, a row that the task does not have, or one named twice.
  SelectedRows(const Task& task, std::vector<int> rows);

  std::unique_ptr<Task> clone() const override { return std::make_unique<SelectedRows>(*this); }

 private:
  void evaluate(const RobotTerms& terms, double t) override;
  void evaluate_drift(const RobotTerms& terms, double t) override;

  std::vector<int> rows_;
};

}  // namespace tope
