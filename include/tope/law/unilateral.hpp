#pragma once

#include <tope/law/bounded_least_squares.hpp>
#include <tope/law/level_rows.hpp>
#include <tope/law/stack_law.hpp>
#include <tope/law/symmetric_eigen.hpp>

namespace tope {

/// Strict priority under bounds that hold as true inequalities: lower <= T y <= upper, whatever the tasks
/// ask.
///
/// Level 0: y = least-norm point inside the bounds. Then for each level k, with M = I at first:
///   z = argmin |A_k (y + M z) - b_k|^2 + damping^2 |z|^2   subject to lower + eta_k <= T (y + M z) <= upper
///   - eta_k y <- y + M z M <- M (I - sum (1 - sqrt(1 - s(sigma))) v v^T),   sigma, v singular values and
///   right vectors of A_k M
/// with s a smooth step from 0 at sigma = 0 to 1 at `lock`, and headroom eta_k = headroom / (1 + k) for level
/// number k. The damping makes each level strictly convex, the soft lock hands a lost direction down
/// gradually, the shrinking headroom leaves every level an interior: together they make the command
/// continuous in the state. Where sigma >= lock, priority is exact. z = 0 is feasible at every level, so a
/// cut-off costs task accuracy and no limit.
class Unilateral final : public StackLaw {
 public:
  struct Options {
    double damping = 0.05;   ///< lambda, in units of the whitened rows
    double lock = 0.1;       ///< sigma_lock, in the same units
    double headroom = 0.01;  ///< eta, in units of the motion [rad/s or m/s; rad/s2 or m/s2]
  };

  /// Errors: ConfigError unless all three options are positive.
  Unilateral(const Stack& stack, const Options& options);

  /// The bounds apply whatever is selected; selection.limits has no part in this law.
  void solve(const Stack& stack, const Selection& selection, Solution& solution) override;

 private:
  void set_bounds(const Stack& stack, int level, const Vector& y);
  void lock_level();

  Options options_;
  LevelRows rows_;
  BoundedLeastSquares solver_;
  SymmetricEigen eigen_;
  Matrix open_;         // M (n x n): directions still open
  Matrix task_;         // A M (m x n)
  Matrix task_gram_;    // A M M^T A^T (m x m)
  Matrix factor_;       // (m x m)
  Matrix open_task_;    // M M^T A^T, column-weighted (n x m)
  Matrix motion_;       // T M (n x n)
  Vector residual_;     // (m)
  Vector motion_at_y_;  // T y (n)
  Vector lower_;
  Vector upper_;
  Matrix no_rows_;  // 0 x n: level 0 has no task
  Vector no_residual_;
};

}  // namespace tope
