// CommandBounds against bisection for the largest scale, clipping, and continuity.
#include "support/random.hpp"

#include <tope/law/command_bounds.hpp>

#include <boost/test/unit_test.hpp>

namespace tope::test {
namespace {

double largest_scale(const Vector& bound, const Vector& first, const Vector& share) {
  const auto inside = [&](double s) { return ((first + s * share).cwiseAbs() - bound).maxCoeff() <= 1e-15; };
  double low = 0.0;
  double high = 1.0;
  if (inside(high)) {
    return high;
  }
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (inside(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

BOOST_AUTO_TEST_SUITE(command_bounds)

BOOST_AUTO_TEST_CASE(takes_the_largest_scale) {
  for (int seed = 0; seed < 300; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = random.integer(1, 12);
      const Vector bound = random.vector(n).cwiseAbs().array() + 0.1;
      const Vector first = random.vector(n, 0.5).cwiseMax(-bound).cwiseMin(bound);
      const Vector share = random.vector(n);
      Vector kept = first;
      Vector command = first + share;
      const CommandBounds result = CommandBounds::apply(bound, kept, command);
      const double expected = largest_scale(bound, first, share);
      BOOST_TEST(std::abs(result.scale - expected) <= 1e-12);
      BOOST_TEST((command - first - expected * share).norm() <= 1e-11);
      BOOST_TEST((command.cwiseAbs() - bound).maxCoeff() <= 1e-15);
      BOOST_TEST(result.clipped == -1);
      BOOST_TEST((result.most_binding >= 0) == (result.scale < 1.0));
    }
  }
}

BOOST_AUTO_TEST_CASE(clips_what_the_limits_ask_beyond_a_bound) {
  const Vector bound = Vector::Ones(3);
  Vector first = (Vector(3) << 0.0, -2.0, 0.5).finished();
  Vector command = (Vector(3) << 0.4, -1.5, 0.5).finished();  // the tasks lead joint 1 back: no scaling
  CommandBounds result = CommandBounds::apply(bound, first, command);
  BOOST_TEST(result.clipped == 1);
  BOOST_TEST(first[1] == -1.0);
  BOOST_TEST(result.scale == 1.0);
  BOOST_TEST((command - (Vector(3) << 0.4, -0.5, 0.5).finished()).norm() <= 1e-15);

  first << 0.0, -2.0, 0.5;
  command << 0.4, -2.5, 0.5;  // the tasks push further out: nothing of them is left
  result = CommandBounds::apply(bound, first, command);
  BOOST_TEST(result.scale == 0.0);
  BOOST_TEST(result.most_binding == 1);
  BOOST_TEST((command - (Vector(3) << 0.0, -1.0, 0.5).finished()).norm() <= 1e-15);
}

BOOST_AUTO_TEST_CASE(takes_infinite_bounds) {
  const Vector bound = (Vector(2) << INFINITY, 1.0).finished();
  Vector first = Vector::Zero(2);
  Vector command = (Vector(2) << 100.0, 0.5).finished();
  BOOST_TEST(CommandBounds::apply(bound, first, command).scale == 1.0);
  BOOST_TEST(command[0] == 100.0);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
