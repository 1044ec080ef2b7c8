#pragma once

#include <tope/law/panel_matrix.hpp>

namespace tope {

/// M + shift I = L D L^T, with L's diagonal of ones and D diagonal: no square root on the way.
class Cholesky {
 public:
  explicit Cholesky(Eigen::Index max_size);

  /// Of the lower triangle of M (m x m). False, and no factor, when a pivot is `least` or smaller.
  bool factorise(const PanelMatrix& m, double shift = 0.0, double least = 0.0);
  /// True when M + shift I is positive definite. What is factorised is then undefined.
  bool positive_definite(const PanelMatrix& m, double shift = 0.0);

  Eigen::Index size() const { return lower_.rows(); }
  /// x <- (M + shift I)^-1 x, in padded(m) numbers, those beyond the last zero.
  void solve(double* x) const;
  // With C the lower triangular factor, C C^T = M + shift I:
  /// x <- C^-1 x, in padded(m) numbers.
  void whiten(double* x) const;
  /// X <- C^-1 X (m x any).
  void whiten(PanelMatrix& x) const;
  /// out = C^-1 (m x m), zeros above its diagonal.
  void invert_factor(PanelMatrix& out) const;

 private:
  void finish_panel(Eigen::Index p, Eigen::Index block);
  void forward(double* x, Eigen::Index stride, Eigen::Index first) const;
  void whiten_panel(double* panel, Eigen::Index cols) const;
  void scale_rows(PanelMatrix& x) const;

  PanelMatrix lower_;      // L below its diagonal, zeros on it and above in the same panel
  Vector inverse_pivots_;  // 1 / D, padded with zeros
};

}  // namespace tope
