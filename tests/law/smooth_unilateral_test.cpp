// SmoothUnilateral: the quadrature against its closed form, bounds, tasks that every solution meets, and what it is for:
// kinks along smooth paths. Not here: the solutions themselves (unilateral_test.cpp).
#include "support/path.hpp"
#include "support/random_stack.hpp"
#include "support/text.hpp"

#include <tope/law/smooth_unilateral.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(smooth_unilateral)
namespace {

const Unilateral::Options defaults;
const Smoothing three{.solutions = 3, .spread = 8.0};

template <typename Law>
Vector solve(Law& law, const Stack& stack) {
  Solution solution(stack.size());
  law.solve(stack, select_all_tasks(stack), solution);
  return solution.y;
}

Vector solve_with(const Stack& stack, double factor) {
  Unilateral::Options options = defaults;
  options.headroom *= factor;
  options.inequality_headroom *= factor;
  Unilateral law(stack, options);
  return solve(law, stack);
}

/// The largest change of slope between one step along a path and the next.
template <typename Law>
double largest_kink(Law& law, const StackPath& path, int steps) {
  double largest = 0.0;
  Vector before = solve(law, path.at(0.0));
  Vector here = solve(law, path.at(1.0 / steps));
  for (int i = 2; i <= steps; ++i) {
    const Vector next = solve(law, path.at(static_cast<double>(i) / steps));
    largest = std::max(largest, steps * (next - 2.0 * here + before).lpNorm<Eigen::Infinity>());
    before = here;
    here = next;
  }
  return largest;
}

}  // namespace

BOOST_AUTO_TEST_CASE(three_solutions_are_the_rule_of_gauss) {
  const double offset = 0.5 * std::sqrt(0.6);
  for (int seed = 0; seed < 30; ++seed) {
    Random random(seed);
    const Stack stack = random_stack(random, {.n = 8, .levels = 3, .beyond = seed % 3 == 0});
    SmoothUnilateral law(stack, defaults, three);
    const Vector expected =
        (5.0 * solve_with(stack, three.factor(0.5 - offset)) + 8.0 * solve_with(stack, three.factor(0.5)) +
         5.0 * solve_with(stack, three.factor(0.5 + offset))) /
        18.0;
    BOOST_TEST((solve(law, stack) - expected).norm() <= 1e-10, "seed " << seed);
  }
}

BOOST_AUTO_TEST_CASE(bounds_hold) {
  for (int seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const Stack stack = random_stack(random, {.n = 7, .levels = 3});
    SmoothUnilateral law(stack, defaults, {.solutions = 5});
    const Vector motion = stack.motion * solve(law, stack);
    BOOST_TEST((motion - stack.motion_upper).maxCoeff() <= 1e-10, "seed " << seed);
    BOOST_TEST((stack.motion_lower - motion).maxCoeff() <= 1e-10, "seed " << seed);
  }
}

// The weights are 0.28 and 0.44. Some paths have a steep place in which one step sees a whole turn: hence the median.
BOOST_AUTO_TEST_CASE(kinks_get_weaker) {
  std::vector<double> left;
  for (int seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const StackPath path(random, 7, false);
    Unilateral plain(path.at(0.0), defaults);
    SmoothUnilateral smooth(path.at(0.0), defaults, three);
    left.push_back(largest_kink(smooth, path, 4000) / largest_kink(plain, path, 4000));
  }
  std::nth_element(left.begin(), left.begin() + 20, left.end());
  BOOST_TEST_MESSAGE("median of what is left of the largest kink: " << left[20]);
  BOOST_TEST(left[20] <= 0.6);
}

BOOST_AUTO_TEST_CASE(bad_options_are_refused) {
  Random random(1);
  const Stack stack = random_stack(random, {.n = 4, .levels = 1});
  check_error([&] { SmoothUnilateral(stack, defaults, {.solutions = 1}); },
              {"smoothing.solutions must be from 2 to 16, got 1"});
  check_error([&] { SmoothUnilateral(stack, defaults, {.solutions = 17}); }, {"got 17"});
  check_error([&] { SmoothUnilateral(stack, defaults, {.spread = 0.0}); },
              {"smoothing.spread must be positive"});
  check_error([&] { SmoothUnilateral(stack, defaults, {.spread = std::numeric_limits<double>::infinity()}); },
              {"smoothing.spread must be positive and finite"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
