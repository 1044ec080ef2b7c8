#include <tope/law/bounded_least_squares.hpp>

#include <algorithm>

namespace tope {
namespace {

constexpr double kDependentPivot =
    1e-10;                  // a held row whose Schur pivot is this small beside its diagonal is dependent
constexpr int kRounds = 6;  // of the primal-dual method, before the dual one takes over

}  // namespace

BoundedLeastSquares::BoundedLeastSquares(int n, int constraints)
    : gram_(n, n),
      factor_(n),
      free_z_(Vector::Zero(PanelMatrix::padded(n))),
      z_(free_z_),
      in_rows_(free_z_),
      in_z_(free_z_),
      normals_(Matrix::Zero(free_z_.size(), n)),
      response_(normals_),
      schur_(n, n),
      schur_factor_(n),
      held_multiplier_(free_z_),
      multipliers_(Vector::Zero(constraints)),
      row_value_(Vector::Zero(PanelMatrix::padded(constraints))),
      dual_(n, constraints),
      hessian_(n, n),
      padded_d_(Matrix::Zero(constraints, n)),
      no_guess_(static_cast<std::size_t>(constraints), 0) {
  held_.reserve(static_cast<std::size_t>(constraints));
  held_sign_.reserve(static_cast<std::size_t>(constraints));
}

bool BoundedLeastSquares::solve(const PanelMatrix& a, const Vector& r, double mu, const PanelMatrix& d,
                                const Vector& lower, const Vector& upper) {
  std::fill(no_guess_.begin(), no_guess_.end(), 0);
  return solve(a, r, mu, d, lower, upper, no_guess_);
}

bool BoundedLeastSquares::solve(const PanelMatrix& a, const Vector& r, double mu, const PanelMatrix& d,
                                const Vector& lower, const Vector& upper, ActiveRows& active) {
  unknowns_ = static_cast<int>(d.cols());
  minimise_freely(a, r, mu);
  multipliers_.setZero();
  z_ = free_z_;
  multiply(d, z_.data(), row_value_.data());
  if ((row_values().array() <= upper.array()).all() && (row_values().array() >= lower.array()).all()) {
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
      note_multipliers();
      return true;
    }
  }
  return fall_back(a, r, mu, d, lower, upper, active);
}

/// By the smaller of A A^T + mu I and A^T A + mu I.
void BoundedLeastSquares::minimise_freely(const PanelMatrix& a, const Vector& r, double mu) {
  by_rows_ = a.rows() < unknowns_;
  free_z_.tail(free_z_.size() - unknowns_).setZero();
  if (by_rows_) {
    multiply_rows(a, gram_);
    factor_.factorise(gram_, mu);
    auto weights = in_rows_.head(PanelMatrix::padded(a.rows()));
    weights = r.head(weights.size());
    factor_.solve(weights.data());
    multiply_transposed(a, weights.data(), free_z_.data());
  } else {
    multiply_columns(a, gram_);
    factor_.factorise(gram_, mu);
    multiply_transposed(a, r.data(), free_z_.data());
    factor_.solve(free_z_.data());
  }
}

/// z <- (A^T A + mu I)^-1 z, by rows as (z - A^T (A A^T + mu I)^-1 A z) / mu.
void BoundedLeastSquares::apply_inverse(const PanelMatrix& a, double mu, double* z) {
  if (!by_rows_) {
    factor_.solve(z);
    return;
  }
  multiply(a, z, in_rows_.data());
  factor_.solve(in_rows_.data());
  multiply_transposed(a, in_rows_.data(), in_z_.data());
  Eigen::Map<Vector> out(z, unknowns_);
  out = (out - in_z_.head(unknowns_)) / mu;
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
bool BoundedLeastSquares::hold(const PanelMatrix& a, double mu, const PanelMatrix& d, const Vector& lower,
                               const Vector& upper) {
  const auto count = static_cast<Eigen::Index>(held_.size());
  if (count > unknowns_) {
    return false;
  }
  schur_.resize_for_rows(count, count);
  held_multiplier_.setZero();
  double largest = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index row = held_[static_cast<std::size_t>(i)];
    auto normal = normals_.col(i);
    auto response = response_.col(i);
    normal.tail(normal.size() - unknowns_).setZero();
    for (Eigen::Index j = 0; j < unknowns_; ++j) {
      normal[j] = d(row, j);
    }
    response = normal;
    apply_inverse(a, mu, response.data());
    const double bound = held_sign_[static_cast<std::size_t>(i)] > 0 ? upper[row] : lower[row];
    held_multiplier_[i] = normal.dot(free_z_) - bound;
    for (Eigen::Index k = 0; k <= i; ++k) {
      schur_(i, k) = normal.dot(response_.col(k));
    }
    largest = std::max(largest, schur_(i, i));
  }
  if (!schur_factor_.factorise(schur_, 0.0, kDependentPivot * largest)) {
    return false;
  }
  schur_factor_.solve(held_multiplier_.data());
  z_ = free_z_;
  for (Eigen::Index i = 0; i < count; ++i) {
    z_ -= held_multiplier_[i] * response_.col(i);
  }
  multiply(d, z_.data(), row_value_.data());
  return true;
}

/// Drops held rows that pull and adds rows that are violated; true when there are none.
bool BoundedLeastSquares::settle(const Vector& lower, const Vector& upper, ActiveRows& active) {
  bool settled = true;
  std::fill(active.begin(), active.end(), 0);
  for (Eigen::Index i = 0; i < multipliers_.size(); ++i) {
    if (row_value_[i] > upper[i] + DualActiveSet::feasibility) {
      active[static_cast<std::size_t>(i)] = 1;
    } else if (row_value_[i] < lower[i] - DualActiveSet::feasibility) {
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

void BoundedLeastSquares::note_multipliers() {
  multipliers_.setZero();
  for (std::size_t i = 0; i < held_.size(); ++i) {
    multipliers_[held_[i]] = held_multiplier_[static_cast<Eigen::Index>(i)];
  }
}

/// The dual method may pass rows that nearly depend on each other on its way, and its steps there are long: the active
/// rows that it ends with are held afresh, without what has gathered in rounding.
bool BoundedLeastSquares::fall_back(const PanelMatrix& a, const Vector& r, double mu, const PanelMatrix& d,
                                    const Vector& lower, const Vector& upper, ActiveRows& active) {
  multiply_columns(a, hessian_);
  multiply_transposed(a, r.data(), in_z_.data());
  d.copy_to(padded_d_.leftCols(unknowns_));
  padded_d_.rightCols(padded_d_.cols() - unknowns_).setZero();
  const bool solved = dual_.solve(hessian_, in_z_, mu, padded_d_, lower, upper);
  multipliers_ = dual_.multipliers();
  mark_pressed(active);
  gather(active);
  if (solved && hold(a, mu, d, lower, upper) && settle(lower, upper, active)) {
    note_multipliers();
    return true;
  }
  mark_pressed(active);
  z_.head(unknowns_) = dual_.z().head(unknowns_);
  multiply(d, z_.data(), row_value_.data());
  return solved;
}

/// The rows that have a multiplier.
void BoundedLeastSquares::mark_pressed(ActiveRows& active) const {
  for (std::size_t i = 0; i < active.size(); ++i) {
    const double multiplier = multipliers_[static_cast<Eigen::Index>(i)];
    active[i] = static_cast<signed char>((multiplier > 0.0) - (multiplier < 0.0));
  }
}

}  // namespace tope
