#pragma once

#include <tope/task/task.hpp>

#include <memory>
#include <vector>

namespace tope {

/// Another task with some of its rows alone, in the order named: e = S e', where S holds rows of the identity. The height
/// of a frame, for example, is row 2 of its position; the others are free. Pursues the error by the other task's
/// reference, is of its type and unit ("mixed" stays "mixed"), and aims at its goal, of which the rows left out are free.
class SelectedRows final : public Task {
 public:
  /// Rows count from 0. Errors: ConfigError for no row, a row that the task does not have, or one named twice.
  SelectedRows(const Task& task, std::vector<int> rows);
  SelectedRows(const SelectedRows& other);
  SelectedRows& operator=(const SelectedRows&) = delete;

  std::string_view type() const override { return task_->type(); }
  std::string_view error_unit() const override { return task_->error_unit(); }
  bool is_goal() const override { return task_->is_goal(); }
  std::unique_ptr<Task> clone() const override { return std::make_unique<SelectedRows>(*this); }
  std::optional<FrameGoal> frame_goal(double t) const override { return task_->frame_goal(t); }
  std::unique_ptr<Task> aimed_at(const Target<PointTarget>& point,
                                 const Target<RotationTarget>& rotation) const override;

 private:
  void evaluate(const RobotTerms& terms, double t) override;
  void evaluate_drift(const RobotTerms& terms, double t) override;

  std::unique_ptr<Task> task_;
  std::vector<int> rows_;
};

}  // namespace tope
