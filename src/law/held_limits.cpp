#include "panel_columns.hpp"

#include <tope/law/held_limits.hpp>

#include <algorithm>

namespace tope {

HeldLimits::HeldLimits(int n, bool with_basis)
    : held_(static_cast<std::size_t>(n), 0),
      closed_(n, 1),
      open_(n),
      with_basis_(with_basis),
      factor_(Matrix::Zero(PanelMatrix::padded(n), n)),
      along_(Vector::Zero(PanelMatrix::padded(n))),
      direction_(along_),
      weights_(along_),
      row_(1, n),
      image_(1, n) {
  joints_.reserve(static_cast<std::size_t>(n));
}

void HeldLimits::release() {
  std::fill(held_.begin(), held_.end(), 0);
  joints_.clear();
  closed_.reset();
  if (with_basis_) {
    open_.reset();
  }
}

bool HeldLimits::within(const Selection& selection) const {
  return std::all_of(joints_.begin(), joints_.end(), [&](Eigen::Index joint) {
    return selection.limits[static_cast<std::size_t>(joint)] != 0;
  });
}

const Vector& HeldLimits::hold(const Stack& stack, Eigen::Index joint) {
  held_[static_cast<std::size_t>(joint)] = 1;
  auto factor = factor_.col(static_cast<Eigen::Index>(joints_.size()));
  factor.setZero();
  double length = 1.0;
  set_columns(direction_.data(), stack.size(), [&](Eigen::Index j) { return stack.motion(joint, j); });
  if (!stack.motion_is_y) {  // those rows are orthonormal as they are
    multiply(closed_.rows(), direction_.data(), factor.data());
    subtract_transposed_product(closed_.rows(), factor.data(), direction_.data());
    length = direction_.norm();
    direction_ /= length;
  }
  factor[closed_.size()] = length;
  joints_.push_back(joint);
  closed_.close(direction_.data());
  if (with_basis_) {
    row_.resize(0, stack.size());
    row_.append_row(direction_.data());
    open_.close(open_.project(row_, image_));
  }
  return direction_;
}

void HeldLimits::meet(const Vector& target, Vector& y) {
  const Eigen::Index count = closed_.size();
  for (Eigen::Index i = 0; i < count; ++i) {
    double rest = target[joints_[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < i; ++j) {
      rest -= factor_(j, i) * weights_[j];
    }
    weights_[i] = rest / factor_(i, i);
  }
  set_columns(weights_.data(), count, [&](Eigen::Index i) { return weights_[i]; });
  multiply_transposed(closed_.rows(), weights_.data(), y.data());
}

}  // namespace tope
