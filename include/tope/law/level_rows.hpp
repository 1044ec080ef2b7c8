#pragma once

#include <tope/law/panel_matrix.hpp>
#include <tope/law/stack.hpp>

namespace tope {

/// The selected rows of one level, stacked. Holds its memory; gather() copies into it.
class LevelRows {
 public:
  LevelRows(int n, int max_rows);

  /// Stacks the selected tasks that share the level of task `first`. Returns the index after the level's last
  /// task.
  std::size_t gather(const Stack& stack, const Selection& selection, std::size_t first);

  int rows() const { return static_cast<int>(a_.rows()); }
  const PanelMatrix& a() const { return a_; }  ///< (rows x n)
  const Vector& b() const { return b_; }       ///< (rows, padded)
  /// True when the rows are one task that asks for the motion itself, A = T, and T is all that is bounded. Then a() is
  /// not filled.
  bool is_motion() const { return is_motion_; }

 private:
  PanelMatrix a_;
  Vector b_;
  bool is_motion_ = false;
};

}  // namespace tope
