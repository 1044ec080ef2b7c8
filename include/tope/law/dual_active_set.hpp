#pragma once

#include <tope/law/panel_matrix.hpp>

#include <vector>

namespace tope {

/// Solves min |A z - r|^2 + mu |z|^2 subject to lower <= D z <= upper, for mu > 0 and bounds with
/// lower <= 0 <= upper or any other set that is not empty.
///
/// The dual active-set method of Goldfarb and Idnani (1983), on two-sided rows. Never allocates. When the
/// iteration bound is reached the result is scaled towards z = 0 until it keeps the bounds, if z = 0 keeps
/// them.
class DualActiveSet {
 public:
  /// A row counts as violated beyond this, in the units of the bounds.
  static constexpr double feasibility = 1e-10;

  DualActiveSet(int n, int constraints);

  /// A^T A (d x d, lower triangle), A^T r (d or more), D (p x n), lower and upper (p); unknowns beyond d <= n are in no
  /// row of A. Returns false when it was cut off.
  bool solve(const PanelMatrix& gram, const Vector& gradient, double mu, const Matrix& d, const Vector& lower,
             const Vector& upper);

  const Vector& z() const { return z_; }
  /// Lagrange multiplier of each row (p) in the half-squared problem: positive presses on the upper bound,
  /// negative on the lower one, zero elsewhere.
  const Vector& multipliers() const { return multipliers_; }

 private:
  struct Violation {
    Eigen::Index row = -1;
    double sign = 0.0;   // +1 upper, -1 lower
    double value = 0.0;  // how far beyond the bound
  };

  void start(const PanelMatrix& gram, const Vector& gradient, double mu);
  Violation worst_violation(const Vector& lower, const Vector& upper) const;
  bool satisfy(const Violation& violation, const Matrix& d, const Vector& lower, const Vector& upper);
  void activate(const Violation& violation, double multiplier);
  void deactivate(int position);
  void shrink_into_bounds(const Matrix& d, const Vector& lower, const Vector& upper);

  Matrix hessian_;   // A^T A + mu I, then its Cholesky factor L
  Matrix basis_;     // L^-T Q: the first active_ columns span the active rows, the others their null space
  Matrix triangle_;  // R of the active rows
  Vector z_;
  Vector direction_;  // basis^T normal (n)
  Vector step_;       // primal step (n)
  Vector dual_step_;  // change of the active multipliers (n)
  Vector active_multiplier_;
  std::vector<Eigen::Index> active_row_;
  std::vector<double> active_sign_;
  Vector multipliers_;
  Vector row_value_;  // D z
  int active_ = 0;
  int iterations_left_ = 0;
};

}  // namespace tope
