#include <tope/law/bounded_least_squares.hpp>
#include <tope/law/small_cholesky.hpp>
#include <tope/law/small_product.hpp>

#include <algorithm>

namespace tope {
namespace {

constexpr double kFeasibility = 1e-10;  // a row counts as violated beyond this, in the units of the bounds
constexpr double kDependence =
    1e-10;                  // a held row whose Schur pivot is this small beside its diagonal is dependent
constexpr int kRounds = 6;  // of the primal-dual method, before the dual one takes over

}  // namespace

BoundedLeastSquares::BoundedLeastSquares(int n, int constraints)
    : factor_(n, n),
      free_z_(Vector::Zero(n)),
      z_(Vector::Zero(n)),
      in_rows_(Vector::Zero(n)),
      response_(n, n),
      schur_(n, n),
      held_multiplier_(n),
      multipliers_(Vector::Zero(constraints)),
      row_value_(constraints),
      dual_(n, constraints),
      padded_d_(Matrix::Zero(constraints, n)),
      no_guess_(static_cast<std::size_t>(constraints), 0) {
  held_.reserve(static_cast<std::size_t>(constraints));
  held_sign_.reserve(static_cast<std::size_t>(constraints));
}

bool BoundedLeastSquares::solve(const Eigen::Ref<const Matrix>& a, const VectorArg& r, double mu,
                                const Eigen::Ref<const Matrix>& d, const Vector& lower, const Vector& upper) {
  std::fill(no_guess_.begin(), no_guess_.end(), 0);
  return solve(a, r, mu, d, lower, upper, no_guess_);
}

bool BoundedLeastSquares::solve(const Eigen::Ref<const Matrix>& a, const VectorArg& r, double mu,
                                const Eigen::Ref<const Matrix>& d, const Vector& lower, const Vector& upper,
                                ActiveRows& active) {
  unknowns_ = static_cast<int>(d.cols());
  factorise(a, mu);
  auto free_z = free_z_.head(unknowns_);
  if (by_rows_) {
    auto weights = in_rows_.head(a.rows());
    weights = r;
    const auto factor = factor_.topLeftCorner(a.rows(), a.rows());
    solve_lower(factor, weights);
    solve_upper(factor, weights);
    multiply(a.transpose(), weights, free_z);
  } else {
    multiply(a.transpose(), r, free_z);
    apply_inverse(a, mu, free_z);
  }
  multipliers_.setZero();
  z_.head(unknowns_) = free_z;
  multiply(d, z(), row_value_);
  if ((row_value_.array() <= upper.array()).all() && (row_value_.array() >= lower.array()).all()) {
    std::fill(active.begin(), active.end(), 0);
    return true;
  }
  if (std::all_of(active.begin(), active.end(), [](signed char sign) { return sign == 0; })) {
    gather(active);
    settle(lower, upper, active);
  }
  for (int round = 0; round < kRounds; ++round) {
    gather(active);
    if (!hold(a, mu, d, lower, upper)) {
      break;
    }
    if (settle(lower, upper, active)) {
      for (std::size_t i = 0; i < held_.size(); ++i) {
        multipliers_[held_[i]] = held_multiplier_[static_cast<Eigen::Index>(i)];
      }
      return true;
    }
  }
  return fall_back(a, r, mu, d, lower, upper, active);
}

/// Factorises the smaller of A A^T + mu I and A^T A + mu I.
void BoundedLeastSquares::factorise(const Eigen::Ref<const Matrix>& a, double mu) {
  by_rows_ = a.rows() < unknowns_;
  const Eigen::Index size = by_rows_ ? a.rows() : unknowns_;
  auto factor = factor_.topLeftCorner(size, size);
  if (by_rows_) {
    multiply(a, a.transpose(), factor);
  } else {
    multiply(a.transpose(), a, factor);
  }
  factor.diagonal().array() += mu;
  factorise_in_place(factor);
}

/// z <- (A^T A + mu I)^-1 z, by rows as (z - A^T (A A^T + mu I)^-1 A z) / mu.
template <typename Out>
void BoundedLeastSquares::apply_inverse(const Eigen::Ref<const Matrix>& a, double mu, Out&& z) {
  if (!by_rows_) {
    const auto factor = factor_.topLeftCorner(unknowns_, unknowns_);
    solve_lower(factor, z);
    solve_upper(factor, z);
    return;
  }
  const auto factor = factor_.topLeftCorner(a.rows(), a.rows());
  auto weights = in_rows_.head(a.rows());
  multiply(a, z, weights);
  solve_lower(factor, weights);
  solve_upper(factor, weights);
  z -= a.transpose().lazyProduct(weights);
  z /= mu;
}

void BoundedLeastSquares::gather(const ActiveRows& active) {
  held_.clear();
  held_sign_.clear();
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (active[i] != 0) {
      held_.push_back(static_cast<Eigen::Index>(i));
      held_sign_.push_back(active[i]);
    }
  }
}

/// The minimum with the held rows at their bounds. False when they depend on each other.
bool BoundedLeastSquares::hold(const Eigen::Ref<const Matrix>& a, double mu,
                               const Eigen::Ref<const Matrix>& d, const Vector& lower, const Vector& upper) {
  const auto count = static_cast<Eigen::Index>(held_.size());
  if (count > unknowns_) {
    return false;
  }
  auto response = response_.topLeftCorner(unknowns_, count);
  auto schur = schur_.topLeftCorner(count, count);
  auto multiplier = held_multiplier_.head(count);
  double largest = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index row = held_[static_cast<std::size_t>(i)];
    auto column = response.col(i);
    column = d.row(row).transpose();
    apply_inverse(a, mu, column);
    const double bound = held_sign_[static_cast<std::size_t>(i)] > 0 ? upper[row] : lower[row];
    multiplier[i] = d.row(row).dot(free_z_.head(unknowns_)) - bound;
    for (Eigen::Index k = i; k < count; ++k) {
      schur(k, i) = d.row(held_[static_cast<std::size_t>(k)]).dot(column);
    }
    largest = std::max(largest, schur(i, i));
  }
  if (!factorise_in_place(schur, kDependence * largest)) {
    return false;
  }
  solve_lower(schur, multiplier);
  solve_upper(schur, multiplier);
  auto now = z_.head(unknowns_);
  now = free_z_.head(unknowns_);
  now -= response.lazyProduct(multiplier);
  multiply(d, now, row_value_);
  return true;
}

/// Drops held rows that pull and adds rows that are violated; true when there are none.
bool BoundedLeastSquares::settle(const Vector& lower, const Vector& upper, ActiveRows& active) {
  bool settled = true;
  std::fill(active.begin(), active.end(), 0);
  for (Eigen::Index i = 0; i < row_value_.size(); ++i) {
    if (row_value_[i] > upper[i] + kFeasibility) {
      active[static_cast<std::size_t>(i)] = 1;
    } else if (row_value_[i] < lower[i] - kFeasibility) {
      active[static_cast<std::size_t>(i)] = -1;
    } else {
      continue;
    }
    settled = false;
  }
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const bool presses = held_sign_[i] * held_multiplier_[static_cast<Eigen::Index>(i)] >= 0.0;
    active[static_cast<std::size_t>(held_[i])] = presses ? held_sign_[i] : 0;
    settled = settled && presses;
  }
  return settled;
}

bool BoundedLeastSquares::fall_back(const Eigen::Ref<const Matrix>& a, const VectorArg& r, double mu,
                                    const Eigen::Ref<const Matrix>& d, const Vector& lower,
                                    const Vector& upper, ActiveRows& active) {
  padded_d_.leftCols(unknowns_) = d;
  padded_d_.rightCols(padded_d_.cols() - unknowns_).setZero();
  const bool solved = dual_.solve(a, r, mu, padded_d_, lower, upper);
  z_ = dual_.z();
  multiply(d, z(), row_value_);
  multipliers_ = dual_.multipliers();
  for (std::size_t i = 0; i < active.size(); ++i) {
    const double multiplier = multipliers_[static_cast<Eigen::Index>(i)];
    active[i] = static_cast<signed char>((multiplier > 0.0) - (multiplier < 0.0));
  }
  return solved;
}

}  // namespace tope
