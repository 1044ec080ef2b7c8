// Whitening: (10), the weighted pseudo-inverse, becomes the ordinary one, in velocity mode and, with the mass matrix for
// its weight, in torque mode.
#include "support/random.hpp"
#include "support/text.hpp"

#include <tope/law/whitening.hpp>

#include <Eigen/LU>
#include <Eigen/QR>
#include <boost/test/unit_test.hpp>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(whitening)

BOOST_AUTO_TEST_CASE(gives_the_weighted_pseudo_inverse) {
  for (int seed = 0; seed < 20; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = random.integer(2, 12);
      const Matrix weight = random.positive_definite(n, 0.2, 4.0);
      const Matrix jacobian = random.matrix(std::max(1, n / 2), n);
      const Vector rate = random.vector(static_cast<int>(jacobian.rows()));
      const Whitening whitening = Whitening::velocity(weight);
      Matrix a;
      whitening.rows(jacobian, a);
      const Vector u = whitening.motion() * a.completeOrthogonalDecomposition().solve(rate);
      const Matrix weighted = weight * jacobian.transpose();
      const Vector expected = weighted * (jacobian * weighted).inverse() * rate;  // J^+ = W J^T (J W J^T)^-1
      BOOST_TEST((u - expected).norm() <= 1e-10 * (1.0 + expected.norm()));
      BOOST_TEST((whitening.motion() * whitening.motion().transpose() - weight).norm() <= 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(weighs_accelerations_by_the_mass_matrix) {
  for (int seed = 0; seed < 20; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = random.integer(2, 40);
      const Matrix mass = random.positive_definite(n, 0.05, 4.0);
      const Matrix jacobian = random.matrix(random.chance(0.5) ? 3 : std::max(1, n / 2), n);
      Whitening whitening = Whitening::torque(n);
      whitening.set_mass_matrix(mass);
      const Matrix& t = whitening.motion();
      BOOST_TEST((t * t.transpose() * mass - Matrix::Identity(n, n)).norm() <= 1e-10);
      BOOST_TEST(t.triangularView<Eigen::StrictlyLower>().toDenseMatrix().norm() == 0.0);
      Matrix a;
      whitening.rows(jacobian, a);
      BOOST_TEST((a - jacobian * t).norm() <= 1e-12 * (1.0 + a.norm()));
    }
  }
}

BOOST_AUTO_TEST_CASE(refuses_what_is_no_weight) {
  Matrix indefinite = Matrix::Identity(2, 2);
  indefinite(1, 1) = -1.0;
  Matrix skewed = Matrix::Identity(2, 2);
  skewed(0, 1) = 0.5;
  for (const Matrix& bad : {indefinite, skewed}) {
    check_error([&] { Whitening::velocity(bad); }, {"weight", "symmetric and positive definite"});
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
