#pragma once

#include <tope/law/level_rows.hpp>
#include <tope/law/stack_law.hpp>
#include <tope/law/symmetric_eigen.hpp>

namespace tope {

/// Strict hierarchy of equalities, (14)-(15) in whitened coordinates, continuous through singularities.
///
/// Limit rows are level 0 and never damped: y = C^+ target, N = I - C^+ C. Then for each level, with
///   B = A A^T + eps^2 I = L L^T,   G = L^-1 A N A^T L^-T with eigenpairs (rho, v),   r = L^-1 (b - A y):
///   y <- y + N A^T L^-T sum g(rho) v v^T r,             g = 1 / (rho + rho_0 max(0, 1 - rho / rho_0)^2)
///   N <- N - sum s(rho) / rho (N A^T L^-T v)(...)^T,    s a smooth step from 0 to 1 on [0, rho_lock]
/// rho in [0, 1) says how much of a task direction is left, whether the arm or a higher level took it. Where
/// every rho >= rho_0 this is the undamped law; where rows conflict or are deficient it is least squares in
/// the metric B^-1.
class Hierarchy final : public StackLaw {
 public:
  struct Options {
    double damped_below = 0.05;  ///< rho_0: directions with less left than this are damped
    double locked_above = 0.03;  ///< rho_lock < rho_0: those with more left are closed to lower levels
    double epsilon = 0.2;        ///< eps, in units of the whitened rows
  };

  /// Errors: ConfigError unless 0 < locked_above < damped_below < 1 and epsilon > 0.
  Hierarchy(const Stack& stack, const Options& options);

  void solve(const Stack& stack, const Selection& selection, Solution& solution) override;
  /// The same with other targets (n) for the limit rows than the stack's.
  void solve(const Stack& stack, const Selection& selection, const Vector& limit_target, Solution& solution);

 private:
  void add_limits(const Stack& stack, const Selection& selection, const Vector& limit_target, Vector& y);
  void add_level(bool last, Solution& solution);
  void add_damped_level(bool last, Solution& solution);

  Options options_;
  LevelRows rows_;
  SymmetricEigen eigen_;
  Matrix null_space_;  // N (n x n)
  Matrix whitened_;    // P = L^-1 A (m x n), then rows of what N loses
  Matrix projected_;   // P N (m x n)
  Matrix gram_;        // B, then G (m x m)
  Matrix factor_;      // G - rho_0 I, then G's factor (m x m)
  Vector residual_;    // r (m)
  Vector weights_;     // (m)
};

}  // namespace tope
