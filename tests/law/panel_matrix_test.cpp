// PanelMatrix and its products against Eigen's, for all shapes up to 13 rows and columns and some larger ones, with
// columns dropped in front and more memory reserved than used. Not here: speed.
#include "support/panels.hpp"
#include "support/random.hpp"

#include <tope/law/panel_matrix.hpp>

#include <boost/test/unit_test.hpp>

#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(panel_matrix)
namespace {

/// M in a larger memory that held other numbers, behind columns that are dropped.
PanelMatrix used(Random& random, const Matrix& m) {
  constexpr int dropped = 3;
  PanelMatrix result(m.rows() + 5, m.cols() + dropped + 1);
  result.set_rows(0, random.matrix(static_cast<int>(m.rows()) + 5, static_cast<int>(m.cols()) + dropped + 1));
  result.resize(m.rows(), m.cols() + dropped);
  Matrix wide = Matrix::Ones(m.rows(), m.cols() + dropped);
  wide.rightCols(m.cols()) = m;
  result.set_rows(0, wide);
  result.drop_front(dropped);
  return result;
}

Matrix lower(const Matrix& m) { return m.triangularView<Eigen::Lower>(); }

void check_rest_is_zero(const Vector& v, Eigen::Index size) {
  BOOST_TEST(v.tail(v.size() - size).norm() == 0.0);
}

void check(Random& random, int rows, int cols) {
  const Matrix m = random.matrix(rows, cols);
  PanelMatrix panels = used(random, m);
  BOOST_TEST((dense(panels) - m).norm() == 0.0);
  const Vector x = random.vector(cols);
  const Vector w = random.vector(rows);
  const double close = 1e-13 * (1.0 + m.norm());

  Vector out = Vector::Constant(PanelMatrix::padded(rows), 7.0);
  multiply(panels, x.data(), out.data());
  BOOST_TEST((out.head(rows) - m * x).norm() <= close * (1.0 + x.norm()));
  check_rest_is_zero(out, rows);
  out = padded(w);
  add_product(panels, x.data(), out.data());
  BOOST_TEST((out.head(rows) - w - m * x).norm() <= close * (1.0 + x.norm()));
  subtract_product(padded(w).data(), panels, x.data(), out.data());
  BOOST_TEST((out.head(rows) - w + m * x).norm() <= close * (1.0 + x.norm()));
  check_rest_is_zero(out, rows);
  Vector across(cols);
  multiply_transposed(panels, padded(w).data(), across.data());
  BOOST_TEST((across - m.transpose() * w).norm() <= close * (1.0 + w.norm()));
  across = x;
  subtract_transposed_product(panels, padded(w).data(), across.data());
  BOOST_TEST((across - x + m.transpose() * w).norm() <= close * (1.0 + w.norm()));

  const int others = random.integer(1, 13);
  const Matrix b = random.matrix(cols, others);
  PanelMatrix product(rows + 2, others + 1);
  multiply(panels, used(random, b), product);
  BOOST_TEST((dense(product) - m * b).norm() <= close * (1.0 + b.norm()));
  multiply_by_transposed(panels, used(random, b.transpose()), product);
  BOOST_TEST((dense(product) - m * b).norm() <= close * (1.0 + b.norm()));
  const Matrix c = random.matrix(rows, others);
  subtract_product(used(random, c), panels, used(random, b), product);
  BOOST_TEST((dense(product) - c + m * b).norm() <= close * (1.0 + b.norm()));

  PanelMatrix gram(rows + cols, rows + cols);
  multiply_rows(panels, gram);
  BOOST_TEST((lower(dense(gram)) - lower(m * m.transpose())).norm() <= close * (1.0 + m.norm()));
  multiply_columns(panels, gram);
  BOOST_TEST((lower(dense(gram)) - lower(m.transpose() * m)).norm() <= close * (1.0 + m.norm()));

  PanelMatrix difference(rows, cols);
  subtract(panels, 0.3, PanelMatrix(m), difference);
  BOOST_TEST((dense(difference) - 0.7 * m).norm() <= close);
  scale(difference, -2.0);
  BOOST_TEST((dense(difference) + 1.4 * m).norm() <= close);
  scale(difference, padded(w).data());
  BOOST_TEST((dense(difference) + 1.4 * w.asDiagonal() * m).norm() <= close * (1.0 + w.norm()));
  difference.assign(panels);
  BOOST_TEST((dense(difference) - m).norm() == 0.0);
  PanelMatrix transposed = used(random, random.matrix(static_cast<int>(PanelMatrix::padded(cols)), rows));
  transposed.assign_transposed(m);
  BOOST_TEST((dense(transposed) - m.transpose()).norm() == 0.0);
  const Vector sums = Vector::Ones(PanelMatrix::padded(rows));
  Vector of_columns = Vector::Ones(PanelMatrix::padded(cols));
  multiply(transposed, sums.data(), of_columns.data());
  check_rest_is_zero(of_columns, cols);

  const Vector down = random.vector(rows);
  subtract_outer(difference, padded(down).data(), x.data());
  BOOST_TEST((dense(difference) - m + down * x.transpose()).norm() <= close * (1.0 + x.norm() * down.norm()));
  out.setZero();
  multiply(difference, x.data(), out.data());
  check_rest_is_zero(out, rows);

  const int first = random.integer(0, cols - 1);
  Vector v = Vector::Zero(cols);
  v.tail(cols - first) = random.vector(cols - first);
  turn(panels, first, v.data() + first, 0.4);
  const Matrix turned = m - 0.4 * m * v * v.transpose();
  BOOST_TEST((dense(panels) - turned).norm() <= close * (1.0 + v.squaredNorm()));
  Vector ones = Vector::Ones(cols);
  multiply(panels, ones.data(), out.data());
  check_rest_is_zero(out, rows);
}

}  // namespace

BOOST_AUTO_TEST_CASE(products_equal_those_of_eigen) {
  for (int rows = 1; rows <= 13; ++rows) {
    for (int cols = 1; cols <= 13; ++cols) {
      BOOST_TEST_CONTEXT("seed 100 * " << rows << " + " << cols) {
        Random random(100 * rows + cols);
        check(random, rows, cols);
      }
    }
  }
  for (const int size : {31, 64, 97}) {
    Random random(size);
    check(random, size, size + 1);
  }
}

BOOST_AUTO_TEST_CASE(rows_can_be_added_one_by_one) {
  Random random(1);
  const Matrix m = random.matrix(6, 5);
  PanelMatrix panels(8, 5);
  panels.set_rows(0, random.matrix(8, 5));
  panels.resize(0, 5);
  for (int i = 0; i < 6; ++i) {
    const Vector row = m.row(i);
    panels.append_row(row.data());
  }
  BOOST_TEST((dense(panels) - m).norm() == 0.0);
  Vector out(8);
  multiply(panels, Vector::Ones(5).eval().data(), out.data());
  check_rest_is_zero(out, 6);
}

BOOST_AUTO_TEST_CASE(rows_of_another_can_be_added) {
  for (int before = 0; before <= 9; ++before) {
    for (int count = 1; count <= 9; ++count) {
      BOOST_TEST_CONTEXT("seed 100 * " << before << " + " << count) {
        Random random(100 * before + count);
        Matrix m = random.matrix(before + count, 5);
        const PanelMatrix other(m.bottomRows(count));
        PanelMatrix panels(20, 5);
        panels.set_rows(0, random.matrix(20, 5));
        panels.resize(before, 5);
        panels.set_rows(0, m.topRows(before));
        panels.append_rows(other);
        BOOST_TEST((dense(panels) - m).norm() == 0.0);
        Vector out(20);
        multiply(panels, Vector::Ones(5).eval().data(), out.data());
        check_rest_is_zero(out.head(PanelMatrix::padded(before + count)), before + count);

        panels.append_row(other, count - 1);
        m.conservativeResize(before + count + 1, 5);
        m.row(before + count) = m.row(before + count - 1);
        BOOST_TEST((dense(panels) - m).norm() == 0.0);
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(rows_of_another_matrix_can_be_added) {
  for (int first = 0; first <= 9; ++first) {
    for (int second = 0; second <= 5; ++second) {
      BOOST_TEST_CONTEXT("seed 10 * " << first << " + " << second) {
        Random random(10 * first + second);
        const Matrix m = random.matrix(first + second, 5);
        PanelMatrix panels = used(random, m.topRows(first));
        panels.append_rows(used(random, m.bottomRows(second)));
        BOOST_TEST((dense(panels) - m).norm() == 0.0);
        Vector out = Vector::Ones(PanelMatrix::padded(first + second));
        multiply(panels, Vector::Ones(5).eval().data(), out.data());
        check_rest_is_zero(out, first + second);
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(nothing_times_nothing_is_zero) {
  PanelMatrix none(0, 4);
  Vector out = Vector::Ones(4);
  multiply_transposed(none, nullptr, out.data());
  BOOST_TEST(out.norm() == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
