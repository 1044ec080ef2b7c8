#include <tope/law/level_rows.hpp>

namespace tope {

LevelRows::LevelRows(int n, int max_rows)
    : a_(max_rows, n), b_(Vector::Zero(PanelMatrix::padded(max_rows))) {}

std::size_t LevelRows::gather(const Stack& stack, const Selection& selection, std::size_t first) {
  Eigen::Index rows = 0;
  std::size_t tasks = 0;
  std::size_t last = first;
  for (; last < stack.tasks.size() && stack.tasks[last].level == stack.tasks[first].level; ++last) {
    if (selection.tasks[last] != 0) {
      rows += stack.tasks[last].b.size();
      ++tasks;
    }
  }
  a_.resize(rows, stack.size());
  b_.tail(b_.size() - rows).setZero();
  is_motion_ = false;
  rows = 0;
  for (std::size_t i = first; i < last; ++i) {
    if (selection.tasks[i] == 0) {
      continue;
    }
    const TaskRows& task = stack.tasks[i];
    is_motion_ = task.is_motion && tasks == 1 && stack.inequality_lower.size() == 0;
    if (!is_motion_) {
      a_.set_rows(rows, task.is_motion ? stack.motion : task.a);
    }
    b_.segment(rows, task.b.size()) = task.b;
    rows += task.b.size();
  }
  return last;
}

}  // namespace tope
