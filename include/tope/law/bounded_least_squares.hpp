#pragma once

#include <tope/law/cholesky.hpp>
#include <tope/law/dual_active_set.hpp>

#include <vector>

namespace tope {

/// Solves min |A z - r|^2 + mu |z|^2 subject to lower <= D z <= upper, for mu > 0 and bounds with
/// lower <= 0 <= upper or any other set that is not empty.
///
/// A primal-dual active set (Hintermueller, Ito, Kunisch 2002): hold a guess of the active rows as equalities, then drop
/// those whose multiplier pulls, add those that are violated, and so on until nothing changes. With the active rows of
/// the last cycle as the guess one round is usual. As it may cycle, after a few rounds the problem goes to a dual
/// active-set method, which cannot. Never allocates.
class BoundedLeastSquares {
 public:
  /// For each row (p): +1 at its upper bound, -1 at its lower one, 0 inactive.
  using ActiveRows = std::vector<signed char>;

  /// For up to n unknowns and exactly `constraints` rows.
  BoundedLeastSquares(int n, int constraints);

  /// A (m x d), r (padded(m), zero beyond), D (p x d), lower and upper (p), d <= n. `active` (p): in, a guess; out, the
  /// active rows. Returns false when it was cut off: z is then scaled towards zero until it keeps the bounds, if z = 0
  /// keeps them.
  bool solve(const PanelMatrix& a, const Vector& r, double mu, const PanelMatrix& d, const Vector& lower,
             const Vector& upper, ActiveRows& active);
  /// The same without a guess.
  bool solve(const PanelMatrix& a, const Vector& r, double mu, const PanelMatrix& d, const Vector& lower,
             const Vector& upper);

  auto z() const { return z_.head(unknowns_); }                             ///< (d)
  auto row_values() const { return row_value_.head(multipliers_.size()); }  ///< D z (p)
  /// A A^T if m < d, A^T A otherwise: lower triangle.
  const PanelMatrix& gram() const { return gram_; }
  /// Lagrange multiplier of each row (p) in the half-squared problem: positive presses on the upper bound,
  /// negative on the lower one, zero elsewhere.
  const Vector& multipliers() const { return multipliers_; }

 private:
  void minimise_freely(const PanelMatrix& a, const Vector& r, double mu);
  void apply_inverse(const PanelMatrix& a, double mu, double* z);
  bool hold(const PanelMatrix& a, double mu, const PanelMatrix& d, const Vector& lower, const Vector& upper);
  bool settle(const Vector& lower, const Vector& upper, ActiveRows& active);
  void gather(const ActiveRows& active);
  void note_multipliers();
  void mark_pressed(ActiveRows& active) const;
  bool fall_back(const PanelMatrix& a, const Vector& r, double mu, const PanelMatrix& d, const Vector& lower,
                 const Vector& upper, ActiveRows& active);

  int unknowns_ = 0;      // d
  bool by_rows_ = false;  // gram_ is A A^T (m x m), not A^T A (d x d)
  PanelMatrix gram_;
  Cholesky factor_;  // of gram_ + mu I
  Vector free_z_;    // minimum without bounds (n), padded as all that panels are multiplied with
  Vector z_;
  Vector in_rows_;     // A z (n)
  Vector in_z_;        // A^T w (n)
  Matrix normals_;     // column i: d_i^T of held row i (n x n)
  Matrix response_;    // column i: H^-1 d_i^T (n x n)
  PanelMatrix schur_;  // D_held H^-1 D_held^T
  Cholesky schur_factor_;
  Vector held_multiplier_;
  std::vector<Eigen::Index> held_;  // rows held as equalities
  std::vector<signed char> held_sign_;
  Vector multipliers_;
  Vector row_value_;  // D z
  DualActiveSet dual_;
  PanelMatrix hessian_;  // A^T A, for the dual method
  Matrix padded_d_;      // D with zero columns (p x n)
  ActiveRows no_guess_;
};

}  // namespace tope
