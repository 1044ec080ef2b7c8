#include <tope/law/row_spectrum.hpp>

#include <cmath>

namespace tope {

RowSpectrum::RowSpectrum(int n)
    : eigen_(n),
      squared_(n),
      left_(Matrix::Zero(PanelMatrix::padded(n), n)),
      directions_(left_),
      projected_(Vector::Zero(left_.rows())) {}

void RowSpectrum::compute(const PanelMatrix& k, const PanelMatrix& gram) {
  by_rows_ = k.rows() < k.cols();
  size_ = static_cast<int>(gram.rows());
  if (size_ == 0) {
    return;
  }
  const SymmetricEigen::Solver& eigen = eigen_.compute(gram);
  squared_.head(size_) = eigen.eigenvalues().cwiseMax(0.0);
  for (int i = 0; i < size_; ++i) {
    if (by_rows_) {
      left_.col(i).head(size_) = eigen.eigenvectors().col(i);
      left_.col(i).tail(left_.rows() - size_).setZero();
      multiply_transposed(k, left_.col(i).data(), directions_.col(i).data());
    } else {
      directions_.col(i).head(size_) = std::sqrt(squared_[i]) * eigen.eigenvectors().col(i);
    }
  }
}

void RowSpectrum::components(const PanelMatrix& k, const Vector& r, Vector& out) {
  if (by_rows_) {
    for (int i = 0; i < size_; ++i) {
      out[i] = left_.col(i).head(size_).dot(r.head(size_));
    }
    return;
  }
  multiply_transposed(k, r.data(), projected_.data());
  for (int i = 0; i < size_; ++i) {
    // u = K v / sigma: where sigma vanishes the direction does, and what multiplies it does not matter
    out[i] =
        squared_[i] > 0.0 ? directions_.col(i).head(size_).dot(projected_.head(size_)) / squared_[i] : 0.0;
  }
}

}  // namespace tope
