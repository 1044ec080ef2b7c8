// CommandBounds against bisection for the largest scale, clipping, rounding and infinite bounds. Not here:
// where the bounds come from (limit room).
#include "support/random.hpp"

#include <tope/law/command_bounds.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(command_bounds)
namespace {

struct Bounds {
  Vector lower;
  Vector upper;

  double excess(const Vector& u) const { return (u - upper).cwiseMax(lower - u).maxCoeff(); }
};

Bounds random_bounds(Random& random, int n) {
  const Vector centre = random.vector(n, 0.3);
  const Vector half = random.vector(n).cwiseAbs().array() + 0.1;
  return {.lower = centre - half, .upper = centre + half};
}

double largest_scale(const Bounds& bounds, const Vector& first, const Vector& share) {
  const auto inside = [&](double s) { return bounds.excess(first + s * share) <= 1e-15; };
  if (inside(1.0)) {
    return 1.0;
  }
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (inside(middle) ? low : high) = middle;
  }
  return low;
}

Vector three(double a, double b, double c) { return Vector3(a, b, c); }

}  // namespace

BOOST_AUTO_TEST_CASE(takes_the_largest_scale) {
  for (int seed = 0; seed < 300; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = random.integer(1, 12);
      const Bounds bounds = random_bounds(random, n);
      const Vector first = random.vector(n, 0.5).cwiseMax(bounds.lower).cwiseMin(bounds.upper);
      const Vector share = random.vector(n);
      Vector kept = first;
      Vector command = first + share;
      const CommandBounds result = CommandBounds::apply(bounds.lower, bounds.upper, kept, command);
      const double expected = largest_scale(bounds, first, share);
      BOOST_TEST(std::abs(result.scale - expected) <= 1e-12);
      BOOST_TEST((command - first - expected * share).norm() <= 1e-11);
      BOOST_TEST(bounds.excess(command) <= 1e-9);
      BOOST_TEST(result.clipped == -1);
      BOOST_TEST((result.most_binding >= 0) == (result.scale < 1.0));
    }
  }
}

BOOST_AUTO_TEST_CASE(clips_what_the_limits_ask_beyond_a_bound) {
  const Vector bound = Vector::Ones(3);
  Vector first = three(0.0, -2.0, 0.5);
  Vector command = three(0.4, -1.5, 0.5);  // the tasks lead joint 1 back: no scaling
  CommandBounds result = CommandBounds::apply(-bound, bound, first, command);
  BOOST_TEST(result.clipped == 1);
  BOOST_TEST(first[1] == -1.0);
  BOOST_TEST(result.scale == 1.0);
  BOOST_TEST((command - three(0.4, -0.5, 0.5)).norm() <= 1e-15);

  first = three(0.0, -2.0, 0.5);
  command = three(0.4, -2.5, 0.5);  // the tasks push further out: nothing of them is left
  result = CommandBounds::apply(-bound, bound, first, command);
  BOOST_TEST(result.scale == 0.0);
  BOOST_TEST(result.most_binding == 1);
  BOOST_TEST((command - three(0.0, -1.0, 0.5)).norm() <= 1e-15);
}

BOOST_AUTO_TEST_CASE(rounding_at_a_bound_does_not_stop_the_tasks) {
  const Vector bound = Vector::Ones(3);
  Vector first = three(1.0, 0.0, 0.0);
  Vector command = three(1.0 + 1e-15, 0.5, 0.0);
  BOOST_TEST(CommandBounds::apply(-bound, bound, first, command).scale == 1.0);
  BOOST_TEST(command[1] == 0.5);
}

BOOST_AUTO_TEST_CASE(takes_infinite_bounds) {
  const Vector bound = three(INFINITY, 1.0, INFINITY);
  Vector first = Vector::Zero(3);
  Vector command = three(100.0, 0.5, -1e6);
  BOOST_TEST(CommandBounds::apply(-bound, bound, first, command).scale == 1.0);
  BOOST_TEST((command - three(100.0, 0.5, -1e6)).norm() == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
