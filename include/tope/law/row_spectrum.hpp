#pragma once

#include <tope/law/panel_matrix.hpp>
#include <tope/law/symmetric_eigen.hpp>

namespace tope {

/// Singular values sigma_i and vectors u_i, v_i of rows K (m x d), from the smaller of their Gram matrices; those beyond
/// min(m, d) are left out.
class RowSpectrum {
 public:
  /// For up to n of them.
  explicit RowSpectrum(int n);

  /// `gram`: lower triangle of K K^T if m < d, of K^T K otherwise.
  void compute(const PanelMatrix& k, const PanelMatrix& gram);

  int size() const { return size_; }
  double squared(int i) const { return squared_[i]; }  ///< sigma_i^2
  /// sigma_i v_i (d).
  const double* direction(int i) const { return directions_.col(i).data(); }
  /// out[i] = u_i^T r, for the K of compute() and r (padded(m)).
  void components(const PanelMatrix& k, const Vector& r, Vector& out);

 private:
  SymmetricEigen eigen_;
  int size_ = 0;
  bool by_rows_ = false;
  Vector squared_;
  Matrix left_;        // u_i, by rows (padded)
  Matrix directions_;  // (padded n x n)
  Vector projected_;   // K^T r
};

}  // namespace tope
