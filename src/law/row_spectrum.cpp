#include <tope/law/row_spectrum.hpp>

#include <cmath>

namespace tope {

RowSpectrum::RowSpectrum(int max_size, int n)
    : squared_(max_size),
      left_(max_size, max_size),
      directions_(max_size, n),
      projected_(Vector::Zero(PanelMatrix::padded(n))) {}

void RowSpectrum::compute(const PanelMatrix& k, const PanelMatrix& gram, SymmetricEigen& eigen) {
  by_rows_ = k.rows() < k.cols();
  if (by_rows_) {
    decompose(gram, eigen, left_);
    multiply(left_, k, directions_);
    return;
  }
  decompose(gram, eigen, directions_);
  for (Eigen::Index i = 0; i < directions_.rows(); ++i) {
    const double sigma = std::sqrt(squared_[i]);
    for (Eigen::Index j = 0; j < directions_.cols(); ++j) {
      directions_(i, j) *= sigma;
    }
  }
}

/// Values, and vectors as rows.
void RowSpectrum::decompose(const PanelMatrix& gram, SymmetricEigen& eigen, PanelMatrix& vectors) {
  if (gram.rows() == 0) {
    vectors.resize(0, 0);
    return;
  }
  const SymmetricEigen::Solver& solver = eigen.compute(gram);
  squared_.head(gram.rows()) = solver.eigenvalues().cwiseMax(0.0);
  vectors.assign_transposed(solver.eigenvectors());
}

void RowSpectrum::components(const PanelMatrix& k, const Vector& r, Vector& out) {
  if (by_rows_) {
    multiply(left_, r.data(), out.data());
    return;
  }
  multiply_transposed(k, r.data(), projected_.data());
  multiply(directions_, projected_.data(), out.data());
  for (int i = 0; i < size(); ++i) {
    // u = K v / sigma: where sigma vanishes the direction does, and what multiplies it does not matter
    out[i] = squared_[i] > 0.0 ? out[i] / squared_[i] : 0.0;
  }
}

}  // namespace tope
