#include "support/random.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>

#include <cmath>
#include <numbers>

namespace tope::test {

double Random::uniform(double low, double high) {
  const double unit = static_cast<double>(engine_() >> 11U) * 0x1p-53;
  return low + (high - low) * unit;
}

double Random::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
  return radius * std::cos(2.0 * std::numbers::pi * uniform(0.0, 1.0));
}

int Random::integer(int low, int high) {
  return low + static_cast<int>(uniform(0.0, 1.0) * (high - low + 1));
}

Vector Random::vector(int n, double scale) {
  return Vector::NullaryExpr(n, [&] { return scale * normal(); });
}

Matrix Random::matrix(int rows, int cols) {
  return Matrix::NullaryExpr(rows, cols, [&] { return normal(); });
}

Matrix Random::orthogonal(int n) {
  return Eigen::HouseholderQR<Matrix>(matrix(n, n)).householderQ() * Matrix::Identity(n, n);
}

Matrix Random::matrix_of_rank(int rows, int cols, int rank, double low, double high) {
  Vector values(rank);
  for (double& value : values) {
    value = uniform(low, high);
  }
  return orthogonal(rows).leftCols(rank) * values.asDiagonal() * orthogonal(cols).topRows(rank);
}

Matrix Random::positive_definite(int n, double low, double high) {
  Vector values(n);
  for (double& value : values) {
    value = uniform(low, high);
  }
  const Matrix basis = orthogonal(n);
  const Matrix product = basis * values.asDiagonal() * basis.transpose();
  return 0.5 * (product + product.transpose());
}

Matrix3 Random::rotation() {
  return Eigen::Quaterniond(Eigen::Vector4d(vector(4).normalized())).toRotationMatrix();
}

Vector3 Random::unit() { return Vector3(vector(3)).normalized(); }

}  // namespace tope::test
