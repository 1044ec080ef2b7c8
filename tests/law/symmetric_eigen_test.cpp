// SymmetricEigen against Eigen's own decomposition, for regular and deficient matrices and for clusters.
// Not here: the heap (law_no_allocation_test).
#include "support/random.hpp"

#include <tope/law/symmetric_eigen.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(symmetric_eigen)
namespace {

void check(SymmetricEigen& eigen, const Matrix& matrix) {
  const SymmetricEigen::Solver& result = eigen.compute(PanelMatrix(matrix));
  const Matrix& vectors = result.eigenvectors();
  const Vector& values = result.eigenvalues();
  const double scale = 1e-13 * (1.0 + matrix.norm());
  BOOST_TEST((vectors * values.asDiagonal() * vectors.transpose() - matrix).norm() <= scale);
  BOOST_TEST((vectors.transpose() * vectors - Matrix::Identity(matrix.rows(), matrix.rows())).norm() <=
             1e-13);
  BOOST_TEST((values - Eigen::SelfAdjointEigenSolver<Matrix>(matrix).eigenvalues()).norm() <= scale);
}

}  // namespace

BOOST_AUTO_TEST_CASE(decomposes_any_size_up_to_its_bound) {
  SymmetricEigen eigen(40);
  for (int size = 1; size <= 40; ++size) {
    BOOST_TEST_CONTEXT("seed and size " << size) {
      Random random(size);
      check(eigen, random.positive_definite(size, 0.1, 3.0));
      const Matrix rows = random.matrix_of_rank(size, size + 3, (size + 1) / 2, 0.5, 2.0);
      check(eigen, rows * rows.transpose());
      check(eigen, Matrix::Identity(size, size));
      check(eigen, Matrix::Zero(size, size));
      check(eigen, Matrix::Ones(size, size));
    }
  }
}

// Three rows go by a closed form: pairs and triples that are equal or nearly so, at either end, and values that vanish.
BOOST_AUTO_TEST_CASE(decomposes_three_rows_wherever_their_values_lie) {
  SymmetricEigen eigen(3);
  Random random(11);
  for (int i = 0; i < 5000; ++i) {
    BOOST_TEST_CONTEXT("seed 11, matrix " << i) {
      const double apart = std::pow(10.0, random.uniform(-16.0, 0.0));
      const double value = random.uniform(0.1, 2.0);
      const Matrix3 turn = random.rotation();
      for (const Vector3& values : {Vector3(value, value * (1.0 + apart), value * (1.0 - apart)),
                                    Vector3(0.0, apart, value), Vector3(value, value + apart, 3.0 * value),
                                    Vector3(apart, value, value), Vector3(value, -value * apart, 0.0)}) {
        check(eigen, turn * values.asDiagonal() * turn.transpose());
        check(eigen, values.asDiagonal().toDenseMatrix());
        check(eigen, std::pow(apart, 10) * turn * values.asDiagonal() * turn.transpose());
      }
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
