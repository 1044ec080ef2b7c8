// RowSpectrum against Eigen's SVD: wide, square and tall rows, regular and deficient, and rows in another metric.
#include "support/panels.hpp"
#include "support/random.hpp"

#include <tope/law/row_spectrum.hpp>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <boost/test/unit_test.hpp>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(row_spectrum)
namespace {

/// What the spectrum says of K = C^-1 A, where r = C^-1 given.
void check_spectrum(RowSpectrum& spectrum, const Matrix& k, const Vector& r, const PanelMatrix& a,
                    const Vector& given) {
  const auto d = k.cols();
  BOOST_TEST(spectrum.size() == std::min(k.rows(), d));
  const Vector values = Eigen::JacobiSVD<Matrix>(k).singularValues();
  Vector components(PanelMatrix::padded(spectrum.size()));
  spectrum.components(a, padded(given), components);
  const Matrix directions = dense(spectrum.directions());
  Matrix gram = Matrix::Zero(d, d);
  Vector product = Vector::Zero(d);
  for (int i = 0; i < spectrum.size(); ++i) {
    BOOST_TEST(std::abs(spectrum.squared(i) - std::pow(values[spectrum.size() - 1 - i], 2)) <= 1e-12);
    BOOST_TEST(std::abs(directions.row(i).squaredNorm() - spectrum.squared(i)) <= 1e-12);
    gram += directions.row(i).transpose() * directions.row(i);
    product += components[i] * directions.row(i);
  }
  BOOST_TEST((gram - k.transpose() * k).norm() <= 1e-12);
  BOOST_TEST((product - k.transpose() * r).norm() <=
             1e-7);  // components of vanishing directions do not count
}

void check(Random& random, const Matrix& k) {
  const auto m = static_cast<int>(k.rows());
  const auto d = static_cast<int>(k.cols());
  const PanelMatrix rows(k);
  PanelMatrix gram(std::max(m, d), std::max(m, d));
  m < d ? multiply_rows(rows, gram) : multiply_columns(rows, gram);
  SymmetricEigen eigen(std::min(m, d));
  RowSpectrum spectrum(std::min(m, d) + 2, d);
  spectrum.compute(rows, gram, eigen);
  const Vector r = random.vector(m);
  check_spectrum(spectrum, k, r, rows, r);
  if (m >= d) {
    return;
  }
  const Matrix metric = random.positive_definite(m, 0.5, 2.0);
  Cholesky factor(m);
  BOOST_REQUIRE(factor.factorise(PanelMatrix(metric)));
  const Matrix c = Eigen::LLT<Matrix>(metric).matrixL();
  spectrum.compute(factor, PanelMatrix(c * k), gram, eigen);
  check_spectrum(spectrum, k, r, PanelMatrix(c * k), c * r);
}

}  // namespace

BOOST_AUTO_TEST_CASE(equals_the_singular_value_decomposition) {
  for (int seed = 0; seed < 100; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int m = random.integer(1, 12);
      const int d = random.integer(1, 12);
      check(random, random.matrix_of_rank(m, d, std::min(m, d), 0.1, 1.0));
      check(random, random.matrix_of_rank(m, d, (std::min(m, d) + 1) / 2, 0.1, 1.0));
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
