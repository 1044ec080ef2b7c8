#pragma once

#include <tope/common/types.hpp>

#include <cstdint>
#include <random>

namespace tope::test {

/// Seeded random numbers, the same on every run and machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high);
  double normal();
  int integer(int low, int high);  ///< both ends included
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }

  Vector vector(int n, double scale = 1.0);  ///< normal entries
  Matrix matrix(int rows, int cols);         ///< normal entries
  Matrix orthogonal(int n);
  /// Matrix (m x n) with `rank` singular values between low and high, the others zero.
  Matrix matrix_of_rank(int rows, int cols, int rank, double low, double high);
  /// Symmetric, with eigenvalues between low and high.
  Matrix positive_definite(int n, double low, double high);
  Matrix3 rotation();
  Vector3 unit();

 private:
  std::mt19937_64 engine_;
};

}  // namespace tope::test
