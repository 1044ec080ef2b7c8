#pragma once

#include <tope/law/closed_rows.hpp>
#include <tope/law/open_basis.hpp>
#include <tope/law/stack.hpp>

#include <vector>

namespace tope {

/// Level 0 of a Hierarchy: rows of T that are held at a value, one added after the other. They are independent and never
/// damped: T_held = L Q with orthonormal rows Q, and y = Q^T L^-1 target.
class HeldLimits {
 public:
  /// For n unknowns; `with_basis`: open() is kept too.
  HeldLimits(int n, bool with_basis);

  void release();
  /// True when all held rows are selected, and perhaps more.
  bool within(const Selection& selection) const;
  bool holds(Eigen::Index joint) const { return held_[static_cast<std::size_t>(joint)] != 0; }
  /// Adds a joint's row. Returns the direction (n, padded) of length one that it closes.
  const Vector& hold(const Stack& stack, Eigen::Index joint);
  /// y (n, padded) that meets the targets (n) of the held rows.
  void meet(const Vector& target, Vector& y);

  const ClosedRows& closed() const { return closed_; }  ///< Q
  const OpenBasis& open() const { return open_; }       ///< what Q leaves

 private:
  std::vector<char> held_;            // one a joint
  std::vector<Eigen::Index> joints_;  // in the order of Q's rows
  ClosedRows closed_;
  OpenBasis open_;
  bool with_basis_;
  Matrix factor_;      // L, row by row in columns: L_ij at (j, i)
  Vector along_;       // of the row that is added, padded
  Vector direction_;   // padded
  Vector weights_;     // L^-1 target, padded
  PanelMatrix row_;    // (1 x n)
  PanelMatrix image_;  // row_ Z
};

}  // namespace tope
