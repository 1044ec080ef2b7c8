// BoundedLeastSquares: optimality conditions and eiquadprog on random, degenerate and dependent problems of
// 1 to 40 unknowns, its multipliers, and what it does when no point satisfies the bounds. Not here: how
// many iterations it takes.
#include "support/kkt.hpp"
#include "support/panels.hpp"
#include "support/random.hpp"
#include "support/reference_unilateral.hpp"

#include <tope/law/bounded_least_squares.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(bounded_least_squares)
namespace {

struct Problem {
  Matrix a;
  Vector r;
  double mu;
  Matrix d;
  Vector lower;
  Vector upper;
};

enum class Kind { plain, dependent, tiny_rows, pressed_at_zero, shifted };

/// Zero is inside the bounds, except where they are shifted away from it (about another point that is
/// inside).
Problem random_problem(Random& random, Kind kind) {
  const int n = random.integer(1, 40);
  const int m = random.integer(0, n + 3);
  const int p = random.integer(1, 2 * n);
  Problem problem{.a = random.matrix(m, n),
                  .r = random.vector(m, random.chance(0.5) ? 1.0 : 30.0),
                  .mu = random.chance(0.5) ? 1.0 : 2.5e-3,
                  .d = random.matrix(p, n),
                  .lower = Vector(p),
                  .upper = Vector(p)};
  for (int i = 0; i < p; ++i) {
    problem.lower[i] = -random.uniform(0.01, 1.0);
    problem.upper[i] = random.uniform(0.01, 1.0);
  }
  switch (kind) {
    case Kind::plain:
      break;
    case Kind::dependent:  // rank of about a half, and repeated rows
      problem.d = random.matrix_of_rank(p, n, std::max(1, std::min(p, n) / 2), 0.5, 2.0);
      for (int i = 1; i < p; i += 3) {
        problem.d.row(i) = (i % 2 == 0 ? 1.0 : -2.0) * problem.d.row(i - 1);
      }
      break;
    case Kind::tiny_rows:
      for (int i = 0; i < p; i += 2) {
        problem.d.row(i) *= i % 4 == 0 ? 0.0 : std::pow(10.0, -random.integer(6, 18));
      }
      break;
    case Kind::pressed_at_zero:  // many bounds meet at z = 0
      for (int i = 0; i < p; i += 2) {
        (i % 4 == 0 ? problem.lower : problem.upper)[i] = 0.0;
      }
      break;
    case Kind::shifted:
      const Vector centre = problem.d * random.vector(n, 2.0);
      problem.lower += centre;
      problem.upper += centre;
      break;
  }
  return problem;
}

bool solve(BoundedLeastSquares& solver, const Problem& p) {
  return solver.solve(PanelMatrix(p.a), padded(p.r), p.mu, PanelMatrix(p.d), p.lower, p.upper);
}

struct Worst {
  double feasibility = 0.0;
  double stationarity = 0.0;
  double multiplier = 0.0;
  double eiquadprog = 0.0;
};

/// The solver's own multipliers: stationary, of the right sign, and zero off the bounds.
void check_multipliers(const Problem& p, const BoundedLeastSquares& solver, Worst& worst) {
  const Vector& z = solver.z();
  const Vector& multipliers = solver.multipliers();
  const Vector gradient = p.a.transpose() * (p.a * z - p.r) + p.mu * z + p.d.transpose() * multipliers;
  const double scale = 1.0 + p.r.norm() * p.a.norm();
  BOOST_TEST(gradient.norm() <= 1e-9 * scale);
  worst.multiplier = std::max(worst.multiplier, gradient.norm() / scale);
  const Vector value = p.d * z;
  for (Eigen::Index i = 0; i < multipliers.size(); ++i) {
    const double slack = multipliers[i] > 0.0 ? p.upper[i] - value[i] : value[i] - p.lower[i];
    BOOST_TEST((multipliers[i] == 0.0 || std::abs(slack) <= 1e-9));
  }
}

Worst check_random_problems(Kind kind, int seeds) {
  Worst worst;
  for (int seed = 0; seed < seeds; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const Problem p = random_problem(random, kind);
      BoundedLeastSquares solver(static_cast<int>(p.d.cols()), static_cast<int>(p.d.rows()));
      BOOST_TEST(solve(solver, p));
      const Vector& z = solver.z();
      const KktResidual kkt = kkt_residual(p.a, p.r, p.mu, p.d, p.lower, p.upper, z, 1e-8);
      const double scale = 1.0 + p.r.norm() * p.a.norm();
      BOOST_TEST(kkt.feasibility <= 1e-9);
      BOOST_TEST(kkt.stationarity <= 1e-8 * scale);
      check_multipliers(p, solver, worst);
      const Vector other = reference_bounded_least_squares(p.a, p.r, p.mu, p.d, p.lower, p.upper);
      const double difference = (z - other).lpNorm<Eigen::Infinity>();
      BOOST_TEST(difference <= 1e-8);
      worst.feasibility = std::max(worst.feasibility, kkt.feasibility);
      worst.stationarity = std::max(worst.stationarity, kkt.stationarity / scale);
      worst.eiquadprog = std::max(worst.eiquadprog, difference);
    }
  }
  BOOST_TEST_MESSAGE("beyond a bound " << worst.feasibility << ", stationarity " << worst.stationarity
                                       << ", with its own multipliers " << worst.multiplier
                                       << ", from eiquadprog " << worst.eiquadprog);
  return worst;
}

}  // namespace

BOOST_AUTO_TEST_CASE(solves_random_problems) { check_random_problems(Kind::plain, 300); }
BOOST_AUTO_TEST_CASE(solves_with_dependent_rows) { check_random_problems(Kind::dependent, 300); }
BOOST_AUTO_TEST_CASE(solves_with_zero_and_tiny_rows) { check_random_problems(Kind::tiny_rows, 300); }
BOOST_AUTO_TEST_CASE(solves_where_many_bounds_meet) { check_random_problems(Kind::pressed_at_zero, 300); }
BOOST_AUTO_TEST_CASE(solves_away_from_zero) { check_random_problems(Kind::shifted, 300); }

BOOST_AUTO_TEST_CASE(is_ordinary_least_squares_without_active_bounds) {
  Random random(3);
  const Matrix a = random.matrix(4, 6);
  const Vector r = random.vector(4);
  const Vector wide = Vector::Constant(6, 1e3);
  const Vector none = Vector::Constant(6, INFINITY);
  BoundedLeastSquares solver(6, 6);
  const Matrix hessian = a.transpose() * a + 0.01 * Matrix::Identity(6, 6);
  const Vector expected = hessian.ldlt().solve(a.transpose() * r);
  BOOST_TEST((solve(solver, {a, r, 0.01, Matrix::Identity(6, 6), -wide, wide})));
  BOOST_TEST((solver.z() - expected).norm() <= 1e-11);
  BOOST_TEST(solver.multipliers().norm() == 0.0);
  BOOST_TEST((solve(solver, {a, r, 0.01, Matrix::Identity(6, 6), -none, none})));
  BOOST_TEST((solver.z() - expected).norm() <= 1e-11);
}

BOOST_AUTO_TEST_CASE(clamps_each_unknown_of_a_separable_problem) {
  Random random(4);
  const Vector r = random.vector(10, 2.0);
  const Vector lower = Vector::Constant(10, -0.5);
  const Vector upper = Vector::Constant(10, 0.7);
  BoundedLeastSquares solver(10, 10);
  BOOST_TEST((solve(solver, {Matrix::Identity(10, 10), r, 1.0, Matrix::Identity(10, 10), lower, upper})));
  BOOST_TEST((solver.z() - (0.5 * r).cwiseMax(lower).cwiseMin(upper)).norm() <= 1e-12);
}

BOOST_AUTO_TEST_CASE(says_so_when_no_point_is_inside) {
  Matrix d(2, 2);
  d << 1.0, 0.0, 1.0, 0.0;
  const Vector lower = (Vector(2) << -2.0, 1.0).finished();
  const Vector upper = (Vector(2) << -1.0, 2.0).finished();
  BoundedLeastSquares solver(2, 2);
  BOOST_TEST((!solve(solver, {Matrix::Identity(2, 2), Vector::Ones(2), 1.0, d, lower, upper})));
  BOOST_TEST(solver.z().allFinite());
}

BOOST_AUTO_TEST_CASE(solves_the_next_problem_afresh) {
  Random random(5);
  const Problem first = random_problem(random, Kind::plain);
  BoundedLeastSquares used(static_cast<int>(first.d.cols()), static_cast<int>(first.d.rows()));
  solve(used, first);
  const Vector z = used.z();
  solve(used, {first.a, 3.0 * first.r, first.mu, first.d, 0.5 * first.lower, first.upper});
  solve(used, first);
  BOOST_TEST((used.z() - z).norm() == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
