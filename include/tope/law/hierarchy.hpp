#pragma once

#include <tope/law/cholesky.hpp>
#include <tope/law/closed_rows.hpp>
#include <tope/law/level_rows.hpp>
#include <tope/law/open_basis.hpp>
#include <tope/law/stack_law.hpp>

#include <vector>

namespace tope {

/// Strict hierarchy of equalities, (14)-(15) in whitened coordinates, continuous through singularities.
///
/// Limit rows are level 0 and never damped: y = C^+ target, N = I - C^+ C. Then for each level, with
///   B = A A^T + eps^2 I = L L^T,   G = L^-1 A N A^T L^-T with eigenpairs (rho, v),   r = L^-1 (b - A y):
///   y <- y + N A^T L^-T sum g(rho) v v^T r,             g = 1 / (rho + rho_0 max(0, 1 - rho / rho_0)^2)
///   N <- N - sum s(rho) / rho (N A^T L^-T v)(...)^T,    s a smooth step from 0 to 1 on [0, rho_lock]
/// rho in [0, 1) says how much of a task direction is left, whether the arm or a higher level took it. Where
/// every rho >= rho_0 this is the undamped law; where rows conflict or are deficient it is least squares in
/// the metric B^-1. N is kept by rows Q that are closed, to which each level adds its own; below a level that takes directions by
/// shares, as Z Z^T: a level then has as many unknowns as directions are open, and its spectrum is taken from the smaller of G and
/// Z^T A^T L^-T L^-1 A Z. What does not depend on the selection is worked out once a cycle, and
/// where a selection only adds limit rows to the one before, those rows alone are added.
class Hierarchy final : public StackLaw {
 public:
  struct Options {
    double damped_below = 0.05;  ///< rho_0: directions with less left than this are damped
    double locked_above = 0.03;  ///< rho_lock < rho_0: those with more left are closed to lower levels
    double epsilon = 0.2;        ///< eps, in units of the whitened rows
  };

  /// Errors: ConfigError unless 0 < locked_above < damped_below < 1 and epsilon > 0.
  Hierarchy(const Stack& stack, const Options& options);

  void begin() override;
  void solve(const Stack& stack, const Selection& selection, Solution& solution) override;
  /// The same with other targets (n) for the limit rows than the stack's.
  void solve(const Stack& stack, const Selection& selection, const Vector& limit_target, Solution& solution);

 private:
  /// What a level has in common whatever limit rows are above it.
  struct Level {
    Level(const Stack& stack, int max_rows);

    std::size_t first = 0;  // task
    std::size_t last = 0;   // one past its last task
    LevelRows given;        // A and b
    PanelMatrix metric;     // B (m x m)
    Cholesky factor;        // B = L L^T, once it is needed
    bool ready = false;
    bool factorised = false;
  };

  void hold_limits(const Stack& stack, const Selection& selection, const Vector& limit_target);
  void hold_limit(const Stack& stack, Eigen::Index joint, double target);
  void release_limits();
  void prepare(const Stack& stack, const Selection& selection, Level& level);
  const PanelMatrix& rows(const Level& level) const;
  void add_level(const Stack& stack, Level& level, bool last, Solution& solution);
  void add_rest();
  bool plain_is_undamped() const;
  void project(bool plain, const Level& level);
  void move();
  bool add_undamped(const Level& level, bool last);
  void whiten(bool plain, Level& level);
  bool add_whitened(bool last);
  void minimise();
  void minimise_damped();
  double damped(double rho) const;

  Options options_;
  std::vector<Level> levels_;
  Level partial_;  // a level of which some tasks are not selected
  RowSpectrum spectrum_;

  std::vector<char> held_;  // joints whose limit row is in:
  Vector held_target_;
  ClosedRows held_rows_;  // Q
  OpenBasis held_open_;   // its twin, where levels begin with that,
  Vector held_y_;         // and y, of these rows alone

  ClosedRows closed_;  // Q (k x n), until a level below one that takes by shares; from there on
  OpenBasis open_;     // Z (n x d)
  bool by_basis_ = false;
  bool needs_basis_ = false;  // some level asks for all freedom and not for y itself: Z from the start
  PanelMatrix motion_;        // T, for a task that asks for it
  PanelMatrix limit_row_;
  PanelMatrix task_;    // A N (m x n) or A Z (m x d), or that times L^-1
  PanelMatrix gram_;    // A N A^T, or G or its small twin
  PanelMatrix excess_;  // A N A^T - rho_0 B
  Cholesky factor_;
  Cholesky clear_;   // of what is positive definite when every rho > rho_0
  Vector y_;         // (n), padded like all that panels are multiplied with
  Vector residual_;  // r (m)
  Vector weights_;   // (m or d)
  Vector step_;      // (d)
  Vector shares_;
};

}  // namespace tope
