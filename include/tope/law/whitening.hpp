#pragma once

#include <tope/common/types.hpp>
#include <tope/law/cholesky.hpp>

namespace tope {

/// The change of unknown that makes every weighted pseudo-inverse (10) an ordinary one: with W = L L^T the command is
/// L y, a task's rows are A = Q L, and the joint motion is T y.
///   velocity mode: W constant, Q = J,      motion = joint velocity,     T = L,    the motion is the command
///   torque mode:   W = H,      Q = J H^-1, motion = joint acceleration, T = L^-T, the command is H times the motion,
/// so that A = J T in both.
class Whitening {
 public:
  /// Velocity mode with a constant weight W (n x n), symmetric positive definite. Errors: ConfigError otherwise.
  static Whitening velocity(const Matrix& weight);
  /// Torque mode for n joints; set_mass_matrix() before each use.
  static Whitening torque(int n);

  /// W = H (n x n), symmetric positive definite. Never allocates.
  void set_mass_matrix(const Matrix& mass_matrix);

  const Matrix& motion() const { return motion_; }  ///< T (n x n): motion = T y
  bool is_identity() const { return identity_; }    ///< T = I
  /// A = J T (m x n).
  void rows(const Matrix& jacobian, Matrix& a) const;

 private:
  explicit Whitening(Matrix motion);

  Matrix motion_;
  PanelMatrix mass_matrix_;
  Cholesky factor_;
  PanelMatrix inverse_;  // L^-1
  bool identity_ = false;
  bool upper_ = false;  // T is upper triangular
};

}  // namespace tope
