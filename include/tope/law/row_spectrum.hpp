#pragma once

#include <tope/law/panel_matrix.hpp>
#include <tope/law/symmetric_eigen.hpp>

namespace tope {

/// Singular values sigma_i and vectors u_i, v_i of rows K (m x d), in ascending order, from the smaller of their Gram
/// matrices; those beyond min(m, d) are left out.
class RowSpectrum {
 public:
  /// For up to max_size of them and d <= n.
  RowSpectrum(int max_size, int n);

  /// `gram`: lower triangle of K K^T if m < d, of K^T K otherwise.
  void compute(const PanelMatrix& k, const PanelMatrix& gram, SymmetricEigen& eigen);

  int size() const { return static_cast<int>(directions_.rows()); }
  const Vector& squared() const { return squared_; }  ///< sigma_i^2 (padded)
  /// v_i, one a row (size x d), to the rounding of K over sigma_i.
  const PanelMatrix& directions() const { return directions_; }
  /// out[i] = v_i^T K^T r (padded), for r (padded(m)) and the K of compute().
  void components(const PanelMatrix& k, const Vector& r, Vector& out);

 private:
  void decompose(const PanelMatrix& gram, SymmetricEigen& eigen, PanelMatrix& vectors);

  bool by_rows_ = false;
  Vector squared_;
  Vector inverses_;   // 1 / sigma_i (padded)
  PanelMatrix left_;  // u_i^T / sigma_i, one a row
  PanelMatrix directions_;
  Vector projected_;  // K^T r
};

}  // namespace tope
