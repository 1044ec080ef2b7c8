#include <tope/law/level_rows.hpp>

namespace tope {

LevelRows::LevelRows(int n, int max_rows) : a_(max_rows, n), b_(max_rows) {}

std::size_t LevelRows::gather(const Stack& stack, const Selection& selection, std::size_t first) {
  rows_ = 0;
  std::size_t i = first;
  for (; i < stack.tasks.size() && stack.tasks[i].level == stack.tasks[first].level; ++i) {
    if (selection.tasks[i] == 0) {
      continue;
    }
    const TaskRows& task = stack.tasks[i];
    const auto m = static_cast<int>(task.a.rows());
    a_.middleRows(rows_, m) = task.a;
    b_.segment(rows_, m) = task.b;
    rows_ += m;
  }
  return i;
}

}  // namespace tope
