#include <tope/law/open_basis.hpp>

#include <algorithm>
#include <cmath>

namespace tope {

OpenBasis::OpenBasis(int n, int image_rows)
    : open_(n, n),
      image_(image_rows, n),
      rows_(n, n),
      reflectors_(Matrix::Zero(PanelMatrix::padded(n), n)),
      along_(Matrix::Zero(PanelMatrix::padded(image_rows), n)),
      triangle_(n, n),
      last_(n, n),
      turned_(n, n),
      shares_(n),
      row_(Vector::Zero(PanelMatrix::padded(n))) {
  reset();
}

void OpenBasis::reset() {
  whole_ = true;
  with_image_ = false;
  open_.set_identity(shares_.size());
}

void OpenBasis::reset(const OpenBasis& other) {
  whole_ = other.whole_;
  with_image_ = false;
  open_.assign(other.open_);
}

void OpenBasis::reset(const ClosedRows& closed) {
  reset();
  rows_.resize(0, size());
  for (int i = 0; i < closed.size(); ++i) {
    if (closed.shares()[i] >= 1.0) {
      rows_.append_row(closed.rows(), i);
    }
  }
  close_rows();
  for (int i = 0; i < closed.size(); ++i) {
    if (closed.shares()[i] < 1.0) {
      multiply_transposed(open_, row_of(closed.rows(), i), shares_.data());
      turn_all(shares_.data(), closed.shares()[i]);
    }
  }
}

/// A row as numbers one after the other, until the next call.
const double* OpenBasis::row_of(const PanelMatrix& m, Eigen::Index row) {
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    row_[j] = m(row, j);
  }
  return row_.data();
}

void OpenBasis::reset(const Matrix& t) {
  reset();
  with_image_ = true;
  image_.resize(t.rows(), t.cols());
  image_.set_rows(0, t);
}

const PanelMatrix& OpenBasis::project(const PanelMatrix& a, PanelMatrix& workspace) const {
  if (whole_) {
    return a;  // NOLINT(bugprone-return-const-ref-from-parameter): as documented, the caller's
  }
  multiply(a, open_, workspace);
  return workspace;
}

void OpenBasis::close(const PanelMatrix& b) {
  rows_.assign(b);
  close_rows();
}

void OpenBasis::close_rows() {
  if (rows_.rows() == 0) {
    return;
  }
  reflect_rows();
  turn_reflectors();
  take_out(open_, whole_);
  if (with_image_) {
    take_out(image_, false);
  }
  whole_ = false;
}

/// Householder reflections H_i = I - t_ii v_i v_i^T bring the rows to lower triangular form. Their product is
/// I - V T V^T with T upper triangular (Schreiber, Van Loan 1989).
void OpenBasis::reflect_rows() {
  const Eigen::Index cols = rows_.cols();
  triangle_.resize_for_rows(rows_.rows(), rows_.rows());
  for (Eigen::Index i = 0; i < rows_.rows(); ++i) {
    double* v = reflectors_.col(i).data();
    std::fill(v, v + i, 0.0);
    const double* row = &rows_(i, 0);
    double even = 0.0;  // two sums, as each waits for its last term
    double odd = 0.0;
    for (Eigen::Index j = i; j < cols; ++j) {
      v[j] = row[PanelMatrix::height * j];
      (j % 2 == 0 ? even : odd) += v[j] * v[j];
    }
    const double norm = std::sqrt(even + odd);
    v[i] += std::copysign(norm, v[i]);
    const double factor = 1.0 / (norm * std::abs(v[i]));  // 2 / |v|^2
    triangle_(i, i) = factor;
    if (i + 1 < rows_.rows()) {
      turn(rows_, i, v + i, factor);
    }
    for (Eigen::Index k = 0; k < i; ++k) {
      shares_[k] = reflectors_.col(k).segment(i, cols - i).dot(reflectors_.col(i).segment(i, cols - i));
    }
    for (Eigen::Index k = 0; k < i; ++k) {
      double sum = 0.0;
      for (Eigen::Index l = k; l < i; ++l) {
        sum += triangle_(k, l) * shares_[l];
      }
      triangle_(k, i) = -factor * sum;
      triangle_(i, k) = 0.0;
    }
  }
}

/// T V^T, without the columns that fall away.
void OpenBasis::turn_reflectors() {
  const Eigen::Index rank = rows_.rows();
  const Eigen::Index cols = rows_.cols() - rank;
  last_.resize_for_rows(rank, cols);
  for (Eigen::Index k = 0; k < rank; ++k) {
    const double* v = reflectors_.col(k).data() + rank;
    for (Eigen::Index j = 0; j < cols; ++j) {
      last_(k, j) = v[j];
    }
  }
  multiply(triangle_, last_, turned_);
}

/// M <- the last columns of M (I - V T V^T). Where M is the identity, M V is V.
void OpenBasis::take_out(PanelMatrix& m, bool identity) {
  const Eigen::Index rank = rows_.rows();
  Matrix& along = identity ? reflectors_ : along_;
  for (Eigen::Index i = 0; i < rank; ++i) {
    if (identity) {
      along.col(i).tail(along.rows() - m.cols()).setZero();
    } else {
      multiply(m, reflectors_.col(i).data(), along.col(i).data());
    }
  }
  m.drop_front(rank);
  subtract_product(m, along, turned_);
}

void OpenBasis::close(const RowSpectrum& spectrum, const Vector& shares) {
  rows_.resize(0, size());
  for (int i = 0; i < spectrum.size(); ++i) {
    if (shares[i] >= 1.0) {
      rows_.append_row(spectrum.directions(), i);
    } else if (shares[i] > ClosedRows::nothing) {
      turn_all(row_of(spectrum.directions(), i), shares[i]);
    }
  }
  close_rows();  // v_i are orthogonal: the shares taken before leave these as they are
}

void OpenBasis::turn_all(const double* v, double factor) {
  turn(open_, 0, v, factor);
  if (with_image_) {
    turn(image_, 0, v, factor);
  }
  whole_ = false;
}

void OpenBasis::close_all() {
  open_.drop_front(size());
  image_.drop_front(image_.cols());
}

}  // namespace tope
