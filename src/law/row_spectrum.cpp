#include "panel_columns.hpp"

#include <tope/law/row_spectrum.hpp>

#include <algorithm>
#include <limits>

namespace tope {

RowSpectrum::RowSpectrum(int max_size, int n)
    : squared_(Vector::Zero(PanelMatrix::padded(max_size))),
      inverses_(squared_),
      left_(max_size, max_size),
      directions_(max_size, n),
      projected_(Vector::Zero(PanelMatrix::padded(n))) {}

void RowSpectrum::compute(const PanelMatrix& k, const PanelMatrix& gram, SymmetricEigen& eigen) {
  by_rows_ = k.rows() < k.cols();
  if (!by_rows_) {
    decompose(gram, eigen, directions_);
    return;
  }
  decompose(gram, eigen, left_);
  constexpr double least = std::numeric_limits<double>::min();  // so that none is divided by zero
  for (Eigen::Index p = 0; p < left_.panels(); ++p) {
    column(inverses_.data(), p) = column(squared_.data(), p).cwiseMax(least).cwiseSqrt().cwiseInverse();
  }
  scale(left_, inverses_.data());
  multiply(left_, k, directions_);
}

/// Values, and vectors as rows.
void RowSpectrum::decompose(const PanelMatrix& gram, SymmetricEigen& eigen, PanelMatrix& vectors) {
  if (gram.rows() == 0) {
    vectors.resize(0, 0);
    return;
  }
  const SymmetricEigen::Solver& solver = eigen.compute(gram);
  const Vector& values = solver.eigenvalues();
  set_columns(squared_.data(), values.size(), [&](Eigen::Index i) { return std::max(0.0, values[i]); });
  vectors.assign_transposed(solver.eigenvectors());
}

void RowSpectrum::components(const PanelMatrix& k, const Vector& r, Vector& out) {
  if (!by_rows_) {
    multiply_transposed(k, r.data(), projected_.data());
    multiply(directions_, projected_.data(), out.data());
    return;
  }
  multiply(left_, r.data(), out.data());
  for (Eigen::Index p = 0; p < left_.panels(); ++p) {
    column(out.data(), p) = column(out.data(), p).cwiseProduct(column(squared_.data(), p));
  }
}

}  // namespace tope
