// RowSpectrum against Eigen's SVD: wide, square and tall rows, regular and deficient.
#include "support/panels.hpp"
#include "support/random.hpp"

#include <tope/law/row_spectrum.hpp>

#include <Eigen/SVD>
#include <boost/test/unit_test.hpp>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(row_spectrum)
namespace {

void check(Random& random, const Matrix& k) {
  const auto m = static_cast<int>(k.rows());
  const auto d = static_cast<int>(k.cols());
  const PanelMatrix rows(k);
  PanelMatrix gram(std::max(m, d), std::max(m, d));
  m < d ? multiply_rows(rows, gram) : multiply_columns(rows, gram);
  SymmetricEigen eigen(std::min(m, d));
  RowSpectrum spectrum(std::min(m, d) + 2, d);
  spectrum.compute(rows, gram, eigen);

  BOOST_TEST(spectrum.size() == std::min(m, d));
  const Vector values = Eigen::JacobiSVD<Matrix>(k).singularValues();
  const Vector r = random.vector(m);
  Vector components(PanelMatrix::padded(spectrum.size()));
  spectrum.components(rows, padded(r), components);
  const Matrix directions = dense(spectrum.directions());
  Matrix outer = Matrix::Zero(d, d);
  Vector product = Vector::Zero(d);
  for (int i = 0; i < spectrum.size(); ++i) {
    BOOST_TEST(std::abs(spectrum.squared()[i] - std::pow(values[spectrum.size() - 1 - i], 2)) <= 1e-12);
    // unit length, but for the rounding of K
    BOOST_TEST(spectrum.squared()[i] * std::abs(directions.row(i).squaredNorm() - 1.0) <= 1e-12);
    outer += spectrum.squared()[i] * directions.row(i).transpose() * directions.row(i);
    product += components[i] * directions.row(i);
  }
  BOOST_TEST((outer - k.transpose() * k).norm() <= 1e-12);
  // components of vanishing directions do not count
  BOOST_TEST((product - k.transpose() * r).norm() <= 1e-7);
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
