#pragma once

#include <tope/law/row_spectrum.hpp>

namespace tope {

/// The directions that higher levels have taken, as orthonormal rows Q (k x n), each by a share sigma between 0 and 1:
///   N = (I - Q^T diag(sigma) Q)^2, what is left to lower levels.
/// The twin of OpenBasis for levels above the first that is damped, and for that one: adding rows costs less than turning a
/// basis of what is left.
class ClosedRows {
 public:
  static constexpr double nothing = 1e-16;  ///< a share no larger is not taken

  /// For n unknowns, and matrices of up to `max_rows` rows that are projected.
  ClosedRows(int n, int max_rows);

  /// Nothing is taken.
  void reset();
  void reset(const ClosedRows& other);

  int size() const { return static_cast<int>(rows_.rows()); }  ///< k
  /// Directions of which something is left: n less the rows that are taken whole.
  int open() const { return static_cast<int>(rows_.cols()) - whole_; }
  bool shared() const { return whole_ < size(); }    ///< some row is not taken whole
  const PanelMatrix& rows() const { return rows_; }  ///< Q
  const Vector& shares() const { return shares_; }   ///< sigma (k, padded with any numbers)

  /// out = A N (m x n), where no row is shared.
  void project(const PanelMatrix& a, PanelMatrix& out);
  /// Takes orthonormal directions (m x n) whole. They and all of Q must be orthogonal.
  void close(const PanelMatrix& rows);
  /// Takes one more direction (n) whole.
  void close(const double* direction);
  /// Takes each direction of the spectrum, which are rows of some A N, by a share. The shares ascend as the spectrum does.
  void close(const RowSpectrum& spectrum, const Vector& shares);
  /// Gives back all but the first `count` rows.
  void keep(int count);
  /// Takes all that is open. What the rows are is then undefined.
  void close_all();

 private:
  PanelMatrix rows_;
  Vector shares_;  // (k)
  int whole_ = 0;
  PanelMatrix along_;  // A Q^T (m x k)
};

}  // namespace tope
