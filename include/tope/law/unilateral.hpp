#pragma once

#include <tope/law/bounded_least_squares.hpp>
#include <tope/law/level_rows.hpp>
#include <tope/law/open_basis.hpp>
#include <tope/law/stack_law.hpp>

namespace tope {

/// Strict priority under bounds that hold as true inequalities: lower <= T y <= upper, whatever the tasks ask, and below
/// them other rows C y >= c.
///
/// Level 0: the least-norm point inside the bounds, with as little slack s in the other rows as it takes,
///   y, s = argmin |y|^2 + |s|^2 / softness^2
///          subject to lower + eta_0 <= T y <= upper - eta_0,  C y + s >= c + eta_0
/// There is such a point whatever C and c are, and s is zero to within softness^2 / |C|^2 of c where the joints' bounds
/// leave the rows some room. Then for each level k, with M = I at first:
///   z = argmin |A_k (y + M z) - b_k|^2 + lambda^2 |z|^2
///       subject to lower + eta_k <= T (y + M z) <= upper - eta_k,  C (y + M z) >= c - s + eta_k
///   y <- y + M z
///   M <- M (I - sum s(sigma) v v^T),   sigma, v singular values and right vectors of A_k M
/// with s the quintic step from 0 at sigma = 0 to 1 at `lock`, and eta_k = headroom / (1 + k) for level number k,
/// times what the stack says of each bound. Near
/// `lock` a direction opens with the third power of what is missing: an opening of lambda is all that a lower level
/// needs to use the direction, and a steeper step would hand it over within a few milliseconds.
///
/// The damping lambda makes each level strictly convex, the soft lock hands a lost direction down gradually, and the
/// shrinking headroom leaves every level an interior: together they make the command continuous in the state.
/// Where sigma >= lock, priority is exact. Lambda falls with the level's residual r = |b_k - A_k y|, as in
/// Sugihara's Levenberg-Marquardt method (2011), so that a goal near a singularity is still reached in time:
///   lambda^2 = fine^2 + (damping^2 - fine^2) r^2 / (r^2 + fine_below^2)
/// z = 0 is feasible at every level, so a cut-off costs task accuracy and no limit.
class Unilateral final : public StackLaw {
 public:
  struct Options {
    double damping = 0.05;       ///< lambda far from the goal, in units of the whitened rows
    double fine_damping = 0.02;  ///< lambda at the goal
    double fine_below = 0.05;    ///< residual between the two, in units of the task's rate [rad/s or m/s]
    double lock = 0.03;          ///< sigma_lock, in units of the whitened rows
    double headroom = 0.01;      ///< eta, in units of the motion [rad/s or m/s]
    double softness = 0.01;      ///< of the inequality rows at level 0, in units of the whitened rows
    /// eta of the inequality rows, in their units [m/s]. Larger than that of the motion: a row that a level's freedom
    /// hardly moves turns quickly, and with it what the row leaves to the level.
    double inequality_headroom = 0.1;
  };

  /// Errors: ConfigError unless all options are positive and fine_damping <= damping.
  Unilateral(const Stack& stack, const Options& options);

  /// The bounds apply whatever is selected; selection.limits has no part in this law.
  void solve(const Stack& stack, const Selection& selection, Solution& solution) override;

 private:
  void open_all(const Stack& stack);
  void solve_limits(Solution& solution);
  const PanelMatrix& softened_rows();
  const PanelMatrix& open_task();
  bool solve_level(const PanelMatrix& task, std::size_t position);
  double squared_damping(double squared_residual) const;
  void set_bounds(const Stack& stack, int level);
  bool all_directions_clear(const PanelMatrix& task);
  void lock_gradually(const PanelMatrix& task);

  Options options_;
  int size_;          // n
  int inequalities_;  // p
  LevelRows rows_;
  BoundedLeastSquares limit_solver_;  // of level 0, for y and s / softness
  BoundedLeastSquares solver_;
  Cholesky clear_;  // of A M M^T A^T - lock^2 I
  SymmetricEigen eigen_;
  RowSpectrum spectrum_;
  OpenBasis open_;    // M up to an orthonormal change of z, and [T; C] M ((n + p) x d)
  PanelMatrix task_;  // A M (m x d)
  Vector shares_;
  Vector residual_;  // (m), padded like all that panels are multiplied with
  Vector y_;
  Matrix bounded_;                                       // [T; C] ((n + p) x n), with inequality rows
  PanelMatrix softened_;                                 // [T 0; C softness I], with inequality rows
  Vector motion_;                                        // T y and C y (n + p)
  Vector slack_;                                         // s (p)
  Vector lower_;                                         // (n + p)
  Vector upper_;                                         // infinite for C y
  std::vector<BoundedLeastSquares::ActiveRows> active_;  // of the last cycle, for each level
  PanelMatrix no_rows_;                                  // 0 x (n + p): level 0 has no task
};

}  // namespace tope
