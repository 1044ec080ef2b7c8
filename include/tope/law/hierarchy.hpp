#pragma once

#include <tope/law/held_limits.hpp>
#include <tope/law/hierarchy_level.hpp>
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
/// Z^T A^T L^-T L^-1 A Z. What does not depend on the selection is worked out once a cycle. Where a selection only adds
/// limit rows to the one before, each closes one more direction to every level, which changes A N and A N A^T by rank one,
/// down to the first damped level that the direction moves.
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
  /// A level's tasks.
  struct Range {
    std::size_t first = 0;
    std::size_t last = 0;  // one past its last task
  };

  void select_tasks(const Selection& selection);
  void hold_limits(const Stack& stack, const Selection& selection);
  void close_in_shared_levels(const Vector& direction);
  void prepare(const Stack& stack, const Selection& selection, std::size_t first, HierarchyLevel& level);
  const PanelMatrix& rows(const HierarchyLevel& level) const;
  void add_known(HierarchyLevel& level, Solution& solution);
  bool add_level(const Stack& stack, HierarchyLevel& level, bool shared, bool last, Solution& solution);
  void find_residual(const HierarchyLevel& level, bool plain);
  void restore_closed(const HierarchyLevel& level);
  void add_rest();
  bool plain_is_undamped() const;
  void project(HierarchyLevel& level);
  void add_clear(const HierarchyLevel& level, bool to_be_closed);
  void add_by_rows(HierarchyLevel& level, bool last);
  const RowSpectrum& minimise_by_rows(HierarchyLevel& level);
  bool add_by_columns(HierarchyLevel& level, bool plain, bool last);
  void whiten_columns(HierarchyLevel& level, bool plain);
  void minimise();
  void minimise_damped(RowSpectrum& spectrum, const PanelMatrix& rows);
  void close_shares(const RowSpectrum& spectrum);
  void move();
  PanelMatrix::Column damped(const PanelMatrix::Column& rho) const;

  Options options_;
  std::vector<Range> ranges_;
  bool needs_basis_;  // some level asks for all freedom and not for y itself: Z from the start
  std::vector<HierarchyLevel> levels_;

  HeldLimits limits_;
  std::vector<char> tasks_;  // of the selection before
  std::vector<char> empty_;  // levels of which it has no task
  // Levels, from the highest, of which A N is known from that selection. All above the last of them are clear, or damped and
  // not moved by any row that was added.
  std::size_t shared_ = 0;

  ClosedRows closed_;  // Q (k x n), until a level below one that takes by shares; from there on
  OpenBasis open_;     // Z (n x d)
  bool by_basis_ = false;
  PanelMatrix motion_;  // T, for a task that asks for it
  PanelMatrix task_;    // L^-1 A Z (m x d)
  PanelMatrix gram_;    // G or its small twin
  Cholesky factor_;
  Cholesky clear_;  // of what is positive definite when every rho > rho_0
  SymmetricEigen eigen_;
  RowSpectrum spectrum_;  // of columns
  Vector y_;              // (n), padded like all that panels are multiplied with
  Vector residual_;       // b - A y (m)
  Vector weights_;        // (m or d)
  Vector step_;           // (n or d)
  Vector shares_;         // (d)
};

}  // namespace tope
