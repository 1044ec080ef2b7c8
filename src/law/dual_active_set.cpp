#include <tope/law/dual_active_set.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Jacobi>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tope {
namespace {

constexpr double kDependentSine = 1e-13;  // squared sine below which a row depends on the active ones
constexpr int kIterationsPerUnknown = 10;

}  // namespace

DualActiveSet::DualActiveSet(int n, int constraints)
    : hessian_(n, n),
      basis_(n, n),
      triangle_(n, n),
      z_(Vector::Zero(n)),
      direction_(n),
      step_(n),
      dual_step_(n),
      active_multiplier_(n),
      active_row_(static_cast<std::size_t>(n)),
      active_sign_(static_cast<std::size_t>(n)),
      multipliers_(Vector::Zero(constraints)),
      row_value_(constraints) {}

bool DualActiveSet::solve(const PanelMatrix& gram, const Vector& gradient, double mu, const Matrix& d,
                          const Vector& lower, const Vector& upper) {
  start(gram, gradient, mu);
  iterations_left_ = kIterationsPerUnknown * static_cast<int>(z_.size());
  bool solved = true;
  while (solved) {
    row_value_.noalias() = d * z_;
    const Violation violation = worst_violation(lower, upper);
    if (violation.row < 0) {
      break;
    }
    solved = satisfy(violation, d, lower, upper);
  }
  multipliers_.setZero();
  for (int i = 0; i < active_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    multipliers_[active_row_[k]] = active_sign_[k] * active_multiplier_[i];
  }
  if (!solved) {
    shrink_into_bounds(d, lower, upper);
  }
  return solved;
}

/// The unconstrained minimum, and the inverse factor of the Hessian as the first basis.
void DualActiveSet::start(const PanelMatrix& gram, const Vector& gradient, double mu) {
  hessian_.setZero();
  for (Eigen::Index j = 0; j < gram.cols(); ++j) {
    for (Eigen::Index i = j; i < gram.rows(); ++i) {
      hessian_(i, j) = gram(i, j);
    }
  }
  hessian_.diagonal().array() += mu;
  const Eigen::LLT<Eigen::Ref<Matrix>> cholesky(hessian_);
  basis_.setIdentity();
  cholesky.matrixU().solveInPlace(basis_);
  z_.setZero();
  z_.head(gram.rows()) = gradient.head(gram.rows());
  cholesky.solveInPlace(z_);
  active_ = 0;
}

DualActiveSet::Violation DualActiveSet::worst_violation(const Vector& lower, const Vector& upper) const {
  Violation worst{.row = -1, .sign = 0.0, .value = feasibility};
  for (Eigen::Index i = 0; i < row_value_.size(); ++i) {
    if (row_value_[i] - upper[i] > worst.value) {
      worst = {.row = i, .sign = 1.0, .value = row_value_[i] - upper[i]};
    }
    if (lower[i] - row_value_[i] > worst.value) {
      worst = {.row = i, .sign = -1.0, .value = lower[i] - row_value_[i]};
    }
  }
  return worst;
}

/// Moves along the active rows until the violated one holds, dropping rows whose multiplier would change
/// sign.
bool DualActiveSet::satisfy(const Violation& violation, const Matrix& d, const Vector& lower,
                            const Vector& upper) {
  const auto n = static_cast<int>(z_.size());
  const double bound = violation.sign > 0.0 ? upper[violation.row] : lower[violation.row];
  double multiplier = 0.0;
  while (iterations_left_-- > 0) {
    // the row as an inequality normal . z >= ...: normal = -sign * d
    direction_.noalias() = basis_.transpose() * d.row(violation.row).transpose();
    direction_ *= -violation.sign;
    const auto free = direction_.tail(n - active_);
    const double curvature = free.squaredNorm();
    step_.noalias() = basis_.rightCols(n - active_) * free;
    auto dual_step = dual_step_.head(active_);
    dual_step = direction_.head(active_);
    triangle_.topLeftCorner(active_, active_).triangularView<Eigen::Upper>().solveInPlace(dual_step);

    constexpr double infinite = std::numeric_limits<double>::infinity();
    double partial = infinite;
    int blocking = -1;
    for (int i = 0; i < active_; ++i) {
      if (dual_step[i] > 0.0 && active_multiplier_[i] < partial * dual_step[i]) {
        partial = active_multiplier_[i] / dual_step[i];
        blocking = i;
      }
    }
    const double excess = violation.sign * (d.row(violation.row).dot(z_) - bound);
    const bool dependent = curvature <= kDependentSine * direction_.squaredNorm();
    const double full = dependent ? infinite : excess / curvature;
    const double length = std::min(partial, full);
    if (length == infinite) {
      return false;  // no point satisfies the active rows and this one
    }
    if (!dependent) {
      z_ += length * step_;
    }
    active_multiplier_.head(active_) -= length * dual_step;
    multiplier += length;
    if (full <= partial) {
      activate(violation, multiplier);
      return true;
    }
    deactivate(blocking);
  }
  return false;
}

/// Appends a row: turns the null-space columns so that the row meets only the first of them.
void DualActiveSet::activate(const Violation& violation, double multiplier) {
  Eigen::JacobiRotation<double> rotation;
  for (auto j = static_cast<int>(z_.size()) - 1; j > active_; --j) {
    double length = 0.0;
    rotation.makeGivens(direction_[j - 1], direction_[j], &length);
    direction_[j - 1] = length;
    direction_[j] = 0.0;
    basis_.applyOnTheRight(j - 1, j, rotation);
  }
  triangle_.col(active_).head(active_ + 1) = direction_.head(active_ + 1);
  active_multiplier_[active_] = multiplier;
  const auto k = static_cast<std::size_t>(active_);
  active_row_[k] = violation.row;
  active_sign_[k] = violation.sign;
  ++active_;
}

/// Removes an active row and restores the triangle.
void DualActiveSet::deactivate(int position) {
  for (int i = position; i + 1 < active_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    active_row_[k] = active_row_[k + 1];
    active_sign_[k] = active_sign_[k + 1];
    active_multiplier_[i] = active_multiplier_[i + 1];
    triangle_.col(i).head(active_) = triangle_.col(i + 1).head(active_);
  }
  --active_;
  Eigen::JacobiRotation<double> rotation;
  for (int i = position; i < active_; ++i) {
    double length = 0.0;
    rotation.makeGivens(triangle_(i, i), triangle_(i + 1, i), &length);
    triangle_(i, i) = length;
    triangle_(i + 1, i) = 0.0;
    const int right = active_ - i - 1;
    if (right > 0) {
      triangle_.block(i, i + 1, 2, right).applyOnTheLeft(0, 1, rotation.adjoint());
    }
    basis_.applyOnTheRight(i, i + 1, rotation);
  }
}

void DualActiveSet::shrink_into_bounds(const Matrix& d, const Vector& lower, const Vector& upper) {
  row_value_.noalias() = d * z_;
  double scale = 1.0;
  for (Eigen::Index i = 0; i < row_value_.size(); ++i) {
    if (row_value_[i] > upper[i]) {
      scale = std::min(scale, std::max(0.0, upper[i]) / row_value_[i]);
    } else if (row_value_[i] < lower[i]) {
      scale = std::min(scale, std::min(0.0, lower[i]) / row_value_[i]);
    }
  }
  z_ *= scale;
}

}  // namespace tope
