#include <tope/law/open_basis.hpp>
#include <tope/law/small_product.hpp>

#include <cmath>

namespace tope {

OpenBasis::OpenBasis(int n, int max_rows)
    : size_(n),
      turned_from_(n),
      open_(Matrix::Identity(n, n)),
      next_open_(n, n),
      reflectors_(n, n),
      scale_(n),
      turn_(n, n),
      faded_(n, max_rows) {}

void OpenBasis::reset() {
  size_ = static_cast<int>(open_.rows());
  whole_ = true;
  open_.setIdentity();
}

void OpenBasis::project(const Eigen::Ref<const Matrix>& a, Eigen::Ref<Matrix> out) const {
  if (whole_) {
    out = a;
  } else {
    multiply(a, columns(), out);
  }
}

void OpenBasis::close(const Eigen::Ref<const Matrix>& b) {
  const auto rank = static_cast<int>(b.rows());
  reflect(b);
  form_turn(rank);
  auto next = next_open_.leftCols(size_ - rank);
  const auto turned = turn_.topLeftCorner(size_, size_ - rank);
  if (whole_) {
    next = turned;
  } else {
    multiply(columns(), turned, next);
  }
  open_.swap(next_open_);
  turned_from_ = size_;
  size_ -= rank;
  whole_ = false;
}

/// Householder reflections that bring B^T to triangular form.
void OpenBasis::reflect(const Eigen::Ref<const Matrix>& b) {
  const Eigen::Index rank = b.rows();
  auto columns = reflectors_.topLeftCorner(size_, rank);
  columns = b.transpose();
  for (Eigen::Index k = 0; k < rank; ++k) {
    auto pivot = columns.col(k).tail(size_ - k);
    pivot[0] += std::copysign(pivot.norm(), pivot[0]);
    scale_[k] = 2.0 / pivot.squaredNorm();
    for (Eigen::Index j = k + 1; j < rank; ++j) {
      auto column = columns.col(j).tail(size_ - k);
      column -= (scale_[k] * pivot.dot(column)) * pivot;
    }
  }
}

/// Q_2: the reflections' product applied to the last columns of the identity.
void OpenBasis::form_turn(int rank) {
  const int left = size_ - rank;
  auto turn = turn_.topLeftCorner(size_, left);
  turn.setZero();
  turn.bottomRows(left).setIdentity();
  for (int k = rank - 1; k >= 0; --k) {
    const auto reflector = reflectors_.col(k).segment(k, size_ - k);
    for (int j = 0; j < left; ++j) {
      auto column = turn.col(j).tail(size_ - k);
      column -= (scale_[k] * reflector.dot(column)) * reflector;
    }
  }
}

void OpenBasis::fade(const Eigen::Ref<const Matrix>& rows, const VectorArg& factors) {
  auto faded = faded_.leftCols(rows.rows());
  multiply(columns(), rows.transpose(), faded);
  faded *= factors.asDiagonal();
  open_.leftCols(size_) -= faded.lazyProduct(rows);
  whole_ = false;
}

}  // namespace tope
