// ClosedRows against dense projectors, A N while rows are added; shares, and the basis of what they leave.
#include "support/panels.hpp"
#include "support/random.hpp"

#include <tope/law/cholesky.hpp>
#include <tope/law/closed_rows.hpp>
#include <tope/law/open_basis.hpp>

#include <Eigen/QR>
#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(closed_rows)
namespace {

/// I - A^+ A.
Matrix null_space(const Matrix& a) {
  return Matrix::Identity(a.cols(), a.cols()) - a.completeOrthogonalDecomposition().pseudoInverse() * a;
}

/// What a level does: its rows, projected and made orthonormal, are taken.
void take(ClosedRows& closed, const Matrix& rows) {
  PanelMatrix projected(rows.rows(), rows.cols());
  closed.project(PanelMatrix(rows), projected);
  PanelMatrix gram(rows.rows(), rows.rows());
  multiply_rows(projected, gram);
  Cholesky factor(rows.rows());
  BOOST_REQUIRE(factor.factorise(gram));
  factor.whiten(projected);
  closed.close(projected);
}

}  // namespace

BOOST_AUTO_TEST_CASE(project_like_dense_null_spaces) {
  for (int seed = 0; seed < 100; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = random.integer(7, 20);
      ClosedRows closed(n, 5);
      Matrix taken(0, n);
      const Matrix probe = random.matrix(5, n);
      for (int level = 0; level < 3; ++level) {
        PanelMatrix projected(5, n);
        closed.project(PanelMatrix(probe), projected);
        BOOST_TEST((dense(projected) - probe * null_space(taken)).norm() <= 1e-11);
        BOOST_TEST(closed.size() == taken.rows());
        BOOST_TEST(closed.open() == n - taken.rows());
        const Matrix rows = random.matrix(random.integer(1, 2), n);
        take(closed, rows);
        Matrix more(taken.rows() + rows.rows(), n);
        more << taken, rows;
        taken = more;
      }
      const Matrix q = dense(closed.rows());
      BOOST_TEST((q * q.transpose() - Matrix::Identity(q.rows(), q.rows())).norm() <= 1e-11);

      ClosedRows copy(n, 5);
      copy.reset(closed);
      BOOST_TEST((dense(copy.rows()) - q).norm() == 0.0);
      closed.close_all();
      BOOST_TEST(closed.open() == 0);
      closed.reset();
      BOOST_TEST(closed.open() == n);
    }
  }
}

BOOST_AUTO_TEST_CASE(take_shares_and_leave_a_basis) {
  for (int seed = 0; seed < 100; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = random.integer(7, 20);
      ClosedRows closed(n, 3);
      const Matrix first = random.matrix(random.integer(1, 3), n);
      take(closed, first);
      PanelMatrix projected(3, n);
      closed.project(PanelMatrix(random.matrix(3, n)), projected);
      PanelMatrix gram(3, 3);
      multiply_rows(projected, gram);
      RowSpectrum spectrum(n, n);
      SymmetricEigen eigen(n);
      spectrum.compute(projected, gram, eigen);
      const Vector shares = (Vector(3) << 0.0, random.uniform(0.0, 1.0), 1.0).finished();
      closed.close(spectrum, shares);
      BOOST_TEST(closed.size() == first.rows() + 2);  // nothing is taken of the first
      BOOST_TEST(closed.open() == n - first.rows() - 1);
      BOOST_TEST(closed.shared());

      Matrix half = null_space(first);  // N = half half^T
      for (int i = 1; i < 3; ++i) {
        const Vector u = dense(spectrum.directions()).row(i).transpose();
        half -= shares[i] * u * u.transpose();
      }
      const Matrix q = dense(closed.rows());
      Matrix by_rows = Matrix::Identity(n, n);
      for (int i = 0; i < closed.size(); ++i) {
        by_rows -= closed.shares()[i] * q.row(i).transpose() * q.row(i);
      }
      BOOST_TEST((by_rows - half).norm() <= 1e-11);
      const int rows = closed.size();
      closed.close(random.vector(n).data());
      BOOST_TEST(closed.shares()[rows] == 1.0);
      BOOST_TEST(closed.open() == n - first.rows() - 2);
      closed.keep(rows);
      BOOST_TEST((dense(closed.rows()) - q).norm() == 0.0);
      Vector along = Vector::Zero(PanelMatrix::padded(rows));
      multiply(closed.rows(), random.vector(n).data(), along.data());
      BOOST_TEST(along.tail(along.size() - rows).norm() == 0.0);
      BOOST_TEST(closed.open() == n - first.rows() - 1);
      OpenBasis open(n);
      open.reset(closed);
      BOOST_TEST(open.size() == closed.open());
      const Matrix z = dense(open.columns());
      BOOST_TEST((z * z.transpose() - half * half.transpose()).norm() <= 1e-11);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
