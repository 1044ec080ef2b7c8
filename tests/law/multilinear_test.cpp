// Multilinear: its recursive form, one transition as the chain's, and what it does beyond its largest
// number of transitions. Not here: continuity, which the chain shares.
#include "support/infinity_norm.hpp"
#include "support/random_stack.hpp"

#include <tope/law/chain.hpp>
#include <tope/law/hierarchy.hpp>
#include <tope/law/multilinear.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(multilinear)
namespace {

template <typename Blend>
Solution blended(const Stack& stack) {
  Hierarchy law(stack, {});
  Blend blend(stack);
  Solution solution(stack.size());
  blend.solve(stack, stack.limit_activation, law, solution);
  return solution;
}

/// u(xi) = (1 - xi_i) u(xi_i = 0) + xi_i u(xi_i = 1), one element after another.
Vector recursion(Stack stack) {
  const auto split = [&](double& activation) {
    const double xi = activation;
    activation = 0.0;
    const Vector without = recursion(stack);
    activation = 1.0;
    return Vector((1.0 - xi) * without + xi * recursion(stack));
  };
  for (double& xi : stack.limit_activation) {
    if (xi > 0.0 && xi < 1.0) {
      return split(xi);
    }
  }
  for (TaskRows& task : stack.tasks) {
    if (task.activation > 0.0 && task.activation < 1.0) {
      return split(task.activation);
    }
  }
  Hierarchy law(stack, {});
  Solution solution(stack.size());
  law.solve(stack, select_complete(stack), solution);
  return solution.y;
}

}  // namespace

BOOST_AUTO_TEST_CASE(equals_its_recursive_form) {
  for (int seed = 0; seed < 60; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = random.integer(3, 15);
      const Stack stack =
          random_stack(random, {.n = n, .levels = 2, .limit_transitions = 3, .task_transitions = 1});
      const Vector expected = recursion(stack);
      const Solution solution = blended<Multilinear>(stack);
      BOOST_TEST(infinity_norm(solution.y - expected) <= 1e-12 * (1.0 + expected.norm()));
      BOOST_TEST(solution.laws == 16);
    }
  }
}

BOOST_AUTO_TEST_CASE(equals_the_chain_for_one_transition) {
  for (int seed = 0; seed < 60; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = random.integer(3, 40);
      const Stack stack = random_stack(
          random, {.n = n, .levels = 3, .limit_transitions = seed % 2, .task_transitions = 1 - seed % 2});
      const Vector y = blended<Multilinear>(stack).y;
      BOOST_TEST(infinity_norm(y - blended<Chain>(stack).y) <= 1e-12 * (1.0 + y.norm()));
    }
  }
}

BOOST_AUTO_TEST_CASE(hands_over_to_the_chain_beyond_its_bound) {
  Random random(1);
  const int most = Multilinear::max_transitions;
  const Stack within = random_stack(random, {.n = 14, .levels = 2, .limit_transitions = most});
  BOOST_TEST(!blended<Multilinear>(within).cut_off);
  BOOST_TEST(blended<Multilinear>(within).laws == 1 << most);
  const Stack beyond = random_stack(random, {.n = 14, .levels = 2, .limit_transitions = most + 1});
  const Solution solution = blended<Multilinear>(beyond);
  BOOST_TEST(solution.cut_off);
  BOOST_TEST(infinity_norm(solution.y - blended<Chain>(beyond).y) == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
