#include <tope/common/error.hpp>
#include <tope/task/selected_rows.hpp>

#include <algorithm>
#include <string>
#include <utility>

namespace tope {
namespace {

void require_rows(const Task& task, const std::vector<int>& rows) {
  if (rows.empty()) {
    throw ConfigError("SelectedRows: names no row");
  }
  for (auto row = rows.begin(); row != rows.end(); ++row) {
    const std::string where = "SelectedRows: row " + std::to_string(*row);
    if (*row < 0 || *row >= task.size()) {
      throw ConfigError(where + ": " + std::string(task.type()) + " has rows 0 to " +
                        std::to_string(task.size() - 1));
    }
    if (std::find(rows.begin(), row, *row) != row) {
      throw ConfigError(where + " is named twice");
    }
  }
}

}  // namespace

SelectedRows::SelectedRows(const Task& task, std::vector<int> rows)
    : WrappedTask(static_cast<int>(rows.size()), task.clone()), rows_(std::move(rows)) {
  require_rows(task, rows_);
}

void SelectedRows::evaluate(const RobotTerms& terms, double t) {
  evaluate_part(*task_, terms, t);
  const Vector& feedforward = feedforward_of(*task_);
  for (Eigen::Index i = 0; i < error_.size(); ++i) {
    const int row = rows_[static_cast<std::size_t>(i)];
    error_[i] = task_->error()[row];
    jacobian_.row(i) = task_->jacobian().row(row);
    feedforward_[i] = feedforward[row];
  }
  near_flip_ = task_->near_flip();
}

void SelectedRows::evaluate_drift(const RobotTerms& terms, double t) {
  evaluate_part_drift(*task_, terms, t);
  for (Eigen::Index i = 0; i < drift_.size(); ++i) {
    drift_[i] = task_->drift()[rows_[static_cast<std::size_t>(i)]];
  }
}

}  // namespace tope
