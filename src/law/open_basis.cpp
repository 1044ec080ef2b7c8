#include <tope/law/open_basis.hpp>

#include <cmath>

namespace tope {

OpenBasis::OpenBasis(int n) : open_(n, n), image_(n, n), rows_(n, n), reflector_(n) { reset(); }

void OpenBasis::reset() {
  whole_ = true;
  orthonormal_ = true;
  with_image_ = false;
  open_.set_identity(reflector_.size());
}

void OpenBasis::reset(const OpenBasis& other) {
  whole_ = other.whole_;
  orthonormal_ = other.orthonormal_;
  with_image_ = false;
  open_.assign(other.open_);
}

void OpenBasis::reset(const Matrix& t) {
  reset();
  with_image_ = true;
  image_.resize_for_rows(t.rows(), t.cols());
  image_.set_rows(0, t);
}

const PanelMatrix& OpenBasis::project(const PanelMatrix& a, PanelMatrix& workspace) const {
  if (whole_) {
    return a;
  }
  multiply(a, open_, workspace);
  return workspace;
}

void OpenBasis::close(const PanelMatrix& b) {
  rows_.assign(b);
  close_rows();
}

/// Householder reflections bring the rows to lower triangular form, Z along with them; its leading columns are then
/// theirs.
void OpenBasis::close_rows() {
  const Eigen::Index rank = rows_.rows();
  for (Eigen::Index i = 0; i < rank; ++i) {
    const double* row = &rows_(i, i);
    const Eigen::Index count = rows_.cols() - i;
    double even = 0.0;  // two sums, as each waits for its last term
    double odd = 0.0;
    for (Eigen::Index j = 0; j < count; ++j) {
      const double value = row[PanelMatrix::height * j];
      reflector_[j] = value;
      (j % 2 == 0 ? even : odd) += value * value;
    }
    const double norm = std::sqrt(even + odd);
    const double pivot = reflector_[0] + std::copysign(norm, reflector_[0]);
    reflector_[0] = pivot;
    const double factor = 1.0 / (norm * std::abs(pivot));  // 2 / |reflector|^2
    if (i + 1 < rank) {
      turn(rows_, i, reflector_.data(), factor);
    }
    turn_all(i, reflector_.data(), factor);
  }
  drop(rank);
}

void OpenBasis::close(const RowSpectrum& spectrum, const Vector& shares) {
  constexpr double nothing = 1e-16;
  rows_.resize(0, size());
  for (int i = 0; i < spectrum.size(); ++i) {
    if (shares[i] >= 1.0) {
      rows_.append_row(spectrum.direction(i));
    } else if (shares[i] > nothing) {
      turn_all(0, spectrum.direction(i), shares[i] / spectrum.squared(i));
      orthonormal_ = false;
    }
  }
  close_rows();  // v_i are orthogonal: the shares taken before leave these as they are
}

void OpenBasis::turn_all(Eigen::Index first, const double* v, double factor) {
  turn(open_, first, v, factor);
  if (with_image_) {
    turn(image_, first, v, factor);
  }
  whole_ = false;
}

void OpenBasis::drop(Eigen::Index count) {
  open_.drop_front(count);
  image_.drop_front(count);
}

}  // namespace tope
