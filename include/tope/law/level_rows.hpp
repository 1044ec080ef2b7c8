#pragma once

#include <tope/law/stack.hpp>

namespace tope {

/// The selected rows of one level, stacked. Holds its memory; gather() copies into it.
class LevelRows {
 public:
  LevelRows(int n, int max_rows);

  /// Stacks the selected tasks that share the level of task `first`. Returns the index after the level's last
  /// task.
  std::size_t gather(const Stack& stack, const Selection& selection, std::size_t first);

  int rows() const { return rows_; }
  auto a() const { return a_.topRows(rows_); }  ///< (rows x n)
  auto b() const { return b_.head(rows_); }     ///< (rows)

 private:
  Matrix a_;
  Vector b_;
  int rows_ = 0;
};

}  // namespace tope
