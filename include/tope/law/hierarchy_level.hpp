#pragma once

#include <tope/law/cholesky.hpp>
#include <tope/law/closed_rows.hpp>
#include <tope/law/level_rows.hpp>
#include <tope/law/row_spectrum.hpp>

namespace tope {

/// One level of a Hierarchy: its rows A, their metric B, and what the levels above leave of them, A N. Where one more
/// direction is closed above, A N and its Gram matrix change by rank one.
class HierarchyLevel {
 public:
  /// For n unknowns and up to `max_rows` rows.
  HierarchyLevel(int n, int max_rows);

  /// The stack has changed, or which of the level's tasks are selected.
  void forget() { ready_ = false; }
  bool ready() const { return ready_; }  ///< gathered since
  /// Takes the selected tasks of the level of task `first`.
  void gather(const Stack& stack, const Selection& selection, std::size_t first);
  const LevelRows& given() const { return given_; }  ///< A and b

  /// B = A A^T + eps^2 I.
  void set_metric(const PanelMatrix& rows, double epsilon);
  /// B's factor, worked out when it is first asked for.
  const Cholesky& metric();

  /// So many rows are closed above, and nothing is projected yet.
  void start(int closed_before);
  /// A N, what closed rows leave of A, with its Gram matrix.
  void project(const PanelMatrix& rows, ClosedRows& closed);
  /// A Z, the rows in a basis of what is open, with its Gram matrix. It may stand in workspace().
  void set_projected(const PanelMatrix& in_basis);
  PanelMatrix& workspace() { return projected_; }
  /// Closes one more direction above, of length one and open until now: `direction` (n, padded). True when it goes on to
  /// the levels below, as what is then left of it: rows that it does not move leave it as it is, and a level that stays
  /// clear leaves a part, of length one again.
  bool close(double* direction, double damped_below);

  /// A N (m x n) or A Z (m x d); L^-1 of it from decompose() on.
  const PanelMatrix& projected() const { return projected_; }
  /// Factorises A N A^T; true when every rho > rho_0, which is `damped_below`.
  bool factorise(double damped_below);
  /// What factorise() found last, of A N and not of A Z.
  bool clear() const { return by_rows_ && clear_; }
  const Cholesky& factor() const { return factor_; }  ///< of A N A^T, where that was so
  /// The spectrum rho of G = L^-1 A N A^T L^-T, with the directions N A^T L^-T v. The level is damped: directions closed above
  /// leave it so.
  RowSpectrum& decompose(SymmetricEigen& eigen);

  /// Rows that were closed above at start(), and directions that close() has closed since.
  int closed_before() const { return closed_before_; }
  int closed_since() const { return closed_since_; }
  const double* closed_direction(int i) const { return directions_.col(i).data(); }

 private:
  LevelRows given_;
  PanelMatrix metric_;  // B (m x m)
  double epsilon_ = 0.0;
  Cholesky metric_factor_;  // B = L L^T
  bool ready_ = false;
  bool factorised_ = false;

  PanelMatrix projected_;
  PanelMatrix gram_;      // of projected_, the lower triangle
  bool by_rows_ = false;  // projected_ is A N, and gram_ is known
  Cholesky clear_factor_;
  Cholesky factor_;
  bool clear_ = false;
  bool whitened_ = false;
  RowSpectrum spectrum_;
  bool decomposed_ = false;

  int closed_before_ = 0;
  int closed_since_ = 0;
  Matrix directions_;   // those closed since, one a column (padded)
  Vector along_;        // A N m, for the direction m that is being closed (m, padded)
  Vector weights_;      // (A N A^T)^-1 of it
  PanelMatrix excess_;  // A N A^T - rho_0 B
};

}  // namespace tope
