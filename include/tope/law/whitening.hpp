#pragma once

#include <tope/common/types.hpp>
#include <tope/law/small_product.hpp>

namespace tope {

/// The change of unknown that makes every weighted pseudo-inverse (10) an ordinary one: with W = L L^T the command is
/// L y, a task's rows are A = Q L, and the joint motion is T y.
///   velocity mode: W constant, Q = J,      motion = joint velocity,     T = L
///   torque mode:   W = H,      Q = J H^-1, motion = joint acceleration, T = L^-T, so that A = J T in both.
class Whitening {
 public:
  /// Velocity mode with a constant weight W (n x n), symmetric positive definite. Errors: ConfigError otherwise.
  static Whitening velocity(const Matrix& weight);
  /// Torque mode for n joints; set_mass_matrix() before each use.
  static Whitening torque(int n);

  /// W = H (n x n), symmetric positive definite. Never allocates.
  void set_mass_matrix(const Matrix& mass_matrix);

  const Matrix& motion() const { return motion_; }  ///< T (n x n): motion = T y
  const Matrix& command() const {
    return command_;
  }  ///< L (n x n): command = L y (plus the bias, in torque mode)
  /// A = J T (m x n).
  void rows(const Matrix& jacobian, Matrix& a) const {
    if (identity_) {
      a = jacobian;
    } else {
      multiply(jacobian, motion_, a);
    }
  }
  /// L^-1 u (n): the y that would give the command u.
  void from_command(const Vector& u, Vector& y) const;

 private:
  Matrix motion_;
  Matrix command_;
  bool identity_ = false;
};

}  // namespace tope
