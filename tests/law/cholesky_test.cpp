// Cholesky against Eigen's solver for 1 to 40 rows, shifted and not, and where it must refuse.
#include "support/panels.hpp"
#include "support/random.hpp"

#include <tope/law/cholesky.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <boost/test/unit_test.hpp>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(cholesky)
namespace {

void check(Cholesky& cholesky, const Matrix& m, double shift, Random& random) {
  const auto size = static_cast<int>(m.rows());
  const Matrix shifted = m + shift * Matrix::Identity(size, size);
  Matrix garbage_above = m;  // the upper triangle must not be read
  garbage_above.triangularView<Eigen::StrictlyUpper>().setConstant(1e3);
  BOOST_TEST(cholesky.factorise(PanelMatrix(garbage_above), shift));

  const Vector b = random.vector(size);
  const Eigen::LLT<Matrix> expected(shifted);
  Vector x = padded(b);
  cholesky.solve(x.data());
  BOOST_TEST((x.head(size) - expected.solve(b)).norm() <= 1e-11 * (1.0 + b.norm()));
  BOOST_TEST(x.tail(x.size() - size).norm() == 0.0);

  const Matrix factor = expected.matrixL();
  x = padded(b);
  cholesky.whiten(x.data());
  BOOST_TEST((factor * x.head(size) - b).norm() <= 1e-12 * (1.0 + b.norm()));
  const Matrix several = random.matrix(size, 5);
  PanelMatrix columns(several);
  cholesky.whiten(columns);
  Matrix whitened(size, 5);
  columns.copy_to(whitened);
  BOOST_TEST((factor * whitened - several).norm() <= 1e-12 * (1.0 + several.norm()));

  PanelMatrix inverse(40, 40);
  cholesky.invert_factor(inverse);
  Matrix dense(size, size);
  inverse.copy_to(dense);
  BOOST_TEST((factor * dense - Matrix::Identity(size, size)).norm() <= 1e-12 * size);
  BOOST_TEST(dense.triangularView<Eigen::StrictlyUpper>().toDenseMatrix().norm() == 0.0);
}

}  // namespace

BOOST_AUTO_TEST_CASE(factorises_any_size_up_to_its_bound) {
  Cholesky cholesky(40);
  for (const int size : {40, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 16, 23, 31, 40}) {
    BOOST_TEST_CONTEXT("seed and size " << size) {
      Random random(size);
      const Matrix m = random.positive_definite(size, 0.1, 3.0);
      check(cholesky, m, 0.0, random);
      check(cholesky, m, 2.5, random);
      check(cholesky, m, -0.05, random);
    }
  }
}

BOOST_AUTO_TEST_CASE(tells_whether_all_eigenvalues_exceed_a_bound) {
  Cholesky cholesky(20);
  for (int size = 1; size <= 20; ++size) {
    Random random(size);
    const Matrix m = random.positive_definite(size, 0.1, 3.0);
    const double smallest = Eigen::SelfAdjointEigenSolver<Matrix>(m).eigenvalues()[0];
    Matrix garbage_above = m;  // the upper triangle must not be read
    garbage_above.triangularView<Eigen::StrictlyUpper>().setConstant(1e3);
    const PanelMatrix panels(garbage_above);
    BOOST_TEST(cholesky.factorise(panels, -smallest + 1e-9));
    BOOST_TEST(!cholesky.factorise(panels, -smallest - 1e-9));
    BOOST_TEST(cholesky.positive_definite(panels, -smallest + 1e-9));
    BOOST_TEST(!cholesky.positive_definite(panels, -smallest - 1e-9));
    // each minor has to count
    for (int i = 0; i < size; ++i) {
      Matrix one_negative = Matrix::Identity(size, size);
      one_negative(i, i) = -1e-3;
      BOOST_TEST(!cholesky.positive_definite(PanelMatrix(one_negative)));
    }
  }
}

BOOST_AUTO_TEST_CASE(refuses_small_pivots_and_what_is_no_number) {
  Cholesky cholesky(3);
  Matrix m = Matrix::Identity(3, 3);
  m(2, 2) = 1e-4;
  BOOST_TEST(cholesky.factorise(PanelMatrix(m), 0.0, 0.9e-4));
  BOOST_TEST(!cholesky.factorise(PanelMatrix(m), 0.0, 1.1e-4));
  m(1, 1) = NAN;
  BOOST_TEST(!cholesky.factorise(PanelMatrix(m)));
  BOOST_TEST(!cholesky.positive_definite(PanelMatrix(m)));
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
