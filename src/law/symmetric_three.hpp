#pragma once

#include "jacobi_rotation.hpp"

#include <tope/common/types.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tope {

/// M = V diag(values) V^T for a symmetric 3 x 3 matrix, in closed form: the eigenvalue that stands apart from the other two,
/// from the cubic; its vector; the other two in the plane across it, by one rotation (Eberly, A Robust Eigensolver for 3 x 3
/// Symmetric Matrices, 2014). To rounding in the norm of M, wherever the eigenvalues lie.
class SymmetricThree {
 public:
  explicit SymmetricThree(const Matrix3& m) {
    const double mean = m.trace() / 3.0;
    const Matrix3 rest = m - mean * Matrix3::Identity();
    const double square = rest.squaredNorm() / 6.0;
    const double spread = std::sqrt(square);
    constexpr double least = 1e-60;  // the fourth power of much less is zero
    if (spread > std::max(least, 4.0 * std::numeric_limits<double>::epsilon() * std::abs(mean))) {
      // eigenvalues over the spread are 2 cos of angles a third of a circle apart
      split(rest, spread * apart(0.5 * rest.determinant() / (square * spread)));
    } else {
      values_.setZero();
      vectors_.setIdentity();
    }
    values_.array() += mean;
  }

  const Vector3& values() const { return values_; }    ///< in ascending order
  const Matrix3& vectors() const { return vectors_; }  ///< one a column

 private:
  /// The root of x^3 - 3 x = 2 c (|c| <= 1) that is furthest from zero, between sqrt 3 and 2 in size: two of Halley's steps
  /// from the chord leave rounding alone, and take less time than 2 cos(acos(c) / 3).
  static double apart(double c) {
    const double size = std::min(1.0, std::abs(c));
    double x = std::numbers::sqrt3 + (2.0 - std::numbers::sqrt3) * size;
    for (int step = 0; step < 2; ++step) {
      const double value = x * (x * x - 3.0) - 2.0 * size;
      const double slope = 3.0 * x * x - 3.0;
      x -= value * slope / (slope * slope - 3.0 * x * value);
    }
    return std::copysign(x, c);
  }

  /// With the eigenvalue that stands apart.
  void split(const Matrix3& m, double apart) {
    const Vector3 axis = null_direction(m - apart * Matrix3::Identity());
    // two directions across it (Duff et al., Building an Orthonormal Basis, Revisited, 2017)
    const double sign = std::copysign(1.0, axis[2]);
    const double a = -1.0 / (sign + axis[2]);
    const double b = axis[0] * axis[1] * a;
    const Vector3 first(1.0 + sign * axis[0] * axis[0] * a, sign * b, -sign * axis[0]);
    const Vector3 second(b, sign + axis[1] * axis[1] * a, -axis[1]);
    const Vector3 image = m * second;
    const double before = first.dot(m * first);
    const double after = second.dot(image);
    const double off = first.dot(image);
    const JacobiRotation turn(after - before, off);
    values_ << before - turn.tangent * off, after + turn.tangent * off, apart;
    vectors_.col(0) = turn.cosine * first - turn.sine * second;
    vectors_.col(1) = turn.sine * first + turn.cosine * second;
    vectors_.col(2) = axis;
    order(0, 1);
    order(1, 2);
    order(0, 1);
  }

  /// Across all rows of a matrix of rank two: the longest of their products.
  static Vector3 null_direction(const Matrix3& m) {
    Vector3 longest = m.col(0).cross(m.col(1));
    double square = longest.squaredNorm();
    for (const Vector3& other : {Vector3(m.col(0).cross(m.col(2))), Vector3(m.col(1).cross(m.col(2)))}) {
      if (other.squaredNorm() > square) {
        longest = other;
        square = other.squaredNorm();
      }
    }
    return longest / std::sqrt(square);
  }

  void order(int i, int j) {
    if (values_[i] > values_[j]) {
      std::swap(values_[i], values_[j]);
      vectors_.col(i).swap(vectors_.col(j));
    }
  }

  Vector3 values_;
  Matrix3 vectors_;
};

}  // namespace tope
