// OpenBasis against dense projectors: Z Z^T after rows are closed whole and by shares, and the image that comes along.
#include "support/panels.hpp"
#include "support/random.hpp"

#include <tope/law/open_basis.hpp>

#include <Eigen/SVD>
#include <boost/test/unit_test.hpp>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(open_basis)
namespace {

/// Z Z^T (I - sum s (2 - s) v v^T) Z Z^T in the coordinates of y: what shares s leave of Z Z^T.
Matrix expected_projector(const Matrix& z, const Matrix& rows, const Vector& shares) {
  const Eigen::JacobiSVD<Matrix> svd(rows * z, Eigen::ComputeThinV);
  Matrix keep = Matrix::Identity(z.cols(), z.cols());
  const Eigen::Index count = svd.singularValues().size();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vector v = svd.matrixV().col(count - 1 - i);  // the spectrum ascends
    keep -= shares[i] * v * v.transpose();
  }
  return z * keep * keep.transpose() * z.transpose();
}

}  // namespace

BOOST_AUTO_TEST_CASE(closes_rows_whole_and_by_shares) {
  for (int seed = 0; seed < 100; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = random.integer(6, 20);
      const Matrix t = random.matrix(n, n);
      OpenBasis open(n);
      open.reset(t);
      PanelMatrix workspace(n, n);
      Matrix z = dense(open.columns());
      BOOST_TEST((z - Matrix::Identity(n, n)).norm() == 0.0);

      const Matrix first = random.matrix(random.integer(1, 3), n);
      const PanelMatrix first_rows(first);
      open.close(open.project(first_rows, workspace));
      z = dense(open.columns());
      BOOST_TEST(open.size() == n - first.rows());
      BOOST_TEST((first * z).norm() <= 1e-12);
      BOOST_TEST((z.transpose() * z - Matrix::Identity(open.size(), open.size())).norm() <= 1e-12);

      const Matrix second = random.matrix(3, n);
      const PanelMatrix second_rows(second);
      const PanelMatrix& projected = open.project(second_rows, workspace);
      BOOST_TEST((dense(projected) - second * z).norm() <= 1e-12);
      PanelMatrix gram(n, n);
      projected.rows() < projected.cols() ? multiply_rows(projected, gram)
                                          : multiply_columns(projected, gram);
      RowSpectrum spectrum(n, n);
      SymmetricEigen eigen(n);
      spectrum.compute(projected, gram, eigen);
      const Vector shares = (Vector(3) << random.uniform(0.0, 1.0), 1.0, random.uniform(0.0, 1.0)).finished();
      const Matrix expected = expected_projector(z, second, shares);
      open.close(spectrum, shares);
      z = dense(open.columns());
      BOOST_TEST(open.size() == n - first.rows() - 1);  // one share is whole
      BOOST_TEST((z * z.transpose() - expected).norm() <= 1e-10);
      BOOST_TEST((dense(open.image()) - t * z).norm() <= 1e-11);

      OpenBasis copy(n);
      copy.reset(open);
      BOOST_TEST((dense(copy.columns()) - z).norm() == 0.0);
      BOOST_TEST((dense(copy.image()) - z).norm() == 0.0);  // it has none
      open.close_all();
      BOOST_TEST(open.size() == 0);
      open.reset();
      BOOST_TEST(open.size() == n);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
