#pragma once

#include <tope/common/types.hpp>

namespace tope {

/// The directions that higher levels leave open: y may still move by Z w. Levels take directions out one after the
/// other, so that each works on fewer unknowns than the one above it.
class OpenBasis {
 public:
  /// For n unknowns, and levels of up to `max_rows` rows.
  OpenBasis(int n, int max_rows);

  /// All directions are open: Z is the identity.
  void reset();
  /// No direction is.
  void close_all() { size_ = 0; }

  int size() const { return size_; }                      ///< d, columns of Z
  auto columns() const { return open_.leftCols(size_); }  ///< Z (n x d)
  /// out = A Z (m x d).
  void project(const Eigen::Ref<const Matrix>& a, Eigen::Ref<Matrix> out) const;

  /// Takes out all directions of the rows B (m x d), of full rank m <= d: Z <- Z Q_2.
  void close(const Eigen::Ref<const Matrix>& b);
  /// The last close()'s Q_2 (d before x d after), for what else lives in these coordinates.
  auto turn() const { return turn_.topLeftCorner(turned_from_, size_); }
  /// Takes each of the orthogonal rows sigma_i v_i^T (m x d) out by a share: Z <- Z (I - sum f_i sigma_i^2 v_i v_i^T).
  void fade(const Eigen::Ref<const Matrix>& rows, const VectorArg& factors);

 private:
  void reflect(const Eigen::Ref<const Matrix>& b);
  void form_turn(int rank);

  int size_;
  int turned_from_;
  bool whole_ = true;  // Z is the identity
  Matrix open_;
  Matrix next_open_;
  Matrix reflectors_;  // Householder vectors in columns (d x m)
  Vector scale_;
  Matrix turn_;
  Matrix faded_;  // Z B^T, column-weighted (n x m)
};

}  // namespace tope
