#pragma once

#include <tope/common/types.hpp>

namespace tope {

/// The change of unknown that makes every weighted pseudo-inverse (10) an ordinary one. With W = L L^T the
/// command is u = L y, a task's rows are A = Q L, and the joint motion is T y. In velocity mode Q = J and T =
/// L.
class Whitening {
 public:
  /// Velocity mode with a constant weight W (n x n), symmetric positive definite. Errors: ConfigError
  /// otherwise.
  static Whitening velocity(const Matrix& weight);

  const Matrix& motion() const { return motion_; }  ///< T (n x n): motion = T y
  /// A = J T (m x n).
  void rows(const Matrix& jacobian, Matrix& a) const { a.noalias() = jacobian * motion_; }
  /// u = L y (n).
  void command(const Vector& y, Vector& u) const { u.noalias() = motion_ * y; }

 private:
  Matrix motion_;
};

}  // namespace tope
