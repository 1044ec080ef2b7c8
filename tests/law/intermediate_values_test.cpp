// IntermediateValues: equal to the convex combination for one transition, the paper's values by a dense
// reference, and the jump of the literal form when a row appears, which is why it is no default. Not here:
// its behaviour in closed loop.
#include "support/infinity_norm.hpp"
#include "support/random_stack.hpp"
#include "support/reference_hierarchy.hpp"

#include <tope/law/intermediate_values.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(intermediate_values)
namespace {

using Scope = IntermediateValues::Scope;

const Hierarchy::Options defaults;

Solution solve(const Stack& stack, Scope scope) {
  IntermediateValues law(stack, defaults, scope);
  Solution solution(stack.size());
  law.solve(stack, select_all_tasks(stack), solution);
  return solution;
}

/// Rows with an activation above zero, and every task or none.
Selection present(const Stack& stack, bool tasks) {
  Selection selection = select_all_tasks(stack);
  for (std::size_t j = 0; j < selection.limits.size(); ++j) {
    selection.limits[j] = stack.limit_activation[static_cast<Eigen::Index>(j)] > 0.0 ? 1 : 0;
  }
  std::fill(selection.tasks.begin(), selection.tasks.end(), tasks ? 1 : 0);
  return selection;
}

/// (16)-(18) or (26)-(29) from the dense reference; the share says whether all its laws were regular.
ReferenceHierarchy reference(const Stack& stack, Scope scope) {
  Vector values = stack.limit_target;
  double share = 1.0;
  for (Eigen::Index j = 0; j < stack.size(); ++j) {
    const double xi = stack.limit_activation[j];
    if (xi > 0.0) {
      Selection without = present(stack, scope == Scope::whole_stack);
      without.limits[static_cast<std::size_t>(j)] = 0;
      const ReferenceHierarchy law = reference_hierarchy(stack, without, defaults.epsilon);
      values[j] = xi * stack.limit_target[j] + (1.0 - xi) * stack.motion.row(j).dot(law.y);
      share = std::min(share, law.smallest_share);
    }
  }
  ReferenceHierarchy result = reference_hierarchy(stack, present(stack, true), values, defaults.epsilon);
  result.smallest_share = std::min(result.smallest_share, share);
  return result;
}

/// Regular random stacks with this many rows in transition.
template <typename Check>
int on_regular_stacks(int seeds, int transitions, Scope scope, Check check) {
  int checked = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const int n = random.integer(4, 40);
      const Stack stack = random_stack(random, {.n = n, .levels = 2, .limit_transitions = transitions});
      const ReferenceHierarchy expected = reference(stack, scope);
      if (expected.smallest_share > defaults.damped_below) {
        ++checked;
        check(stack, expected.y);
      }
    }
  }
  return checked;
}

}  // namespace

BOOST_AUTO_TEST_CASE(is_the_convex_combination_for_one_transition) {
  double largest = 0.0;
  const int checked = on_regular_stacks(200, 1, Scope::whole_stack, [&](const Stack& stack, const Vector&) {
    double xi = 0.0;
    for (const double activation : stack.limit_activation) {
      xi = activation < 1.0 ? std::max(xi, activation) : xi;
    }
    const Vector with = reference_hierarchy(stack, present(stack, true), defaults.epsilon).y;
    const Vector without = reference_hierarchy(stack, select_all_tasks(stack), defaults.epsilon).y;
    const double error = infinity_norm(solve(stack, Scope::whole_stack).y - (1.0 - xi) * without - xi * with);
    BOOST_TEST(error <= 1e-9);
    largest = std::max(largest, error);
  });
  BOOST_TEST(checked >= 50);
  BOOST_TEST_MESSAGE(checked << " stacks, largest deviation " << largest);
}

BOOST_AUTO_TEST_CASE(equals_dense_reference_with_several_transitions) {
  for (const Scope scope : {Scope::whole_stack, Scope::limit_rows}) {
    const int checked = on_regular_stacks(200, 3, scope, [&](const Stack& stack, const Vector& expected) {
      const Solution solution = solve(stack, scope);
      BOOST_TEST(infinity_norm(solution.y - expected) <= 1e-9);
      BOOST_TEST(solution.laws == 4);
    });
    BOOST_TEST(checked >= 50);
  }
}

BOOST_AUTO_TEST_CASE(literal_form_jumps_where_a_row_appears_and_the_other_does_not) {
  Random random(3);
  Stack stack = random_stack(random, {.n = 6, .levels = 1, .complete_limits = 0.0, .deficient = 0.0});
  const auto change = [&](Scope scope) {
    stack.limit_activation[0] = 0.0;
    const Vector before = solve(stack, scope).y;
    stack.limit_activation[0] = 1e-9;
    return infinity_norm(solve(stack, scope).y - before);
  };
  BOOST_TEST(change(Scope::whole_stack) <= 1e-7);
  BOOST_TEST(change(Scope::limit_rows) >= 1e-2);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
