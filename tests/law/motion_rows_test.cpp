// What the laws may leave out of their work: rows that are the motion itself, T = I, and limit rows held since the last
// selection of a cycle. Each against the same law with everything spelled out.
#include "support/random_stack.hpp"

#include <tope/law/hierarchy.hpp>
#include <tope/law/unilateral.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(motion_rows)
namespace {

template <typename Law>
Vector solve(const Stack& stack, const Selection& selection) {
  Law law(stack, {});
  Solution solution(stack.size());
  law.begin();
  law.solve(stack, selection, solution);
  return solution.y;
}

/// A random stack with a task on all joints somewhere in it, once by its mark alone and once as rows.
struct Pair {
  Stack marked;
  Stack spelled_out;
};

Pair random_pair(Random& random, bool motion_is_y) {
  RandomStackOptions options;
  options.n = random.integer(3, 20);
  options.weak = 0.2;
  Stack stack = random_stack(random, options);
  if (motion_is_y) {
    stack.motion = Matrix::Identity(options.n, options.n);
  }
  const auto position = static_cast<std::size_t>(random.integer(0, static_cast<int>(stack.tasks.size())));
  const bool shared = random.chance(0.3) && position > 0;
  const int level = position == 0 ? 1 : stack.tasks[position - 1].level + (shared ? 0 : 1);
  for (std::size_t i = position; i < stack.tasks.size(); ++i) {
    stack.tasks[i].level += 2;
  }
  TaskRows rows{.level = level, .activation = 1.0, .a = stack.motion, .b = random.vector(options.n)};
  Pair pair{.marked = stack, .spelled_out = stack};
  const auto at = static_cast<std::ptrdiff_t>(position);
  pair.spelled_out.tasks.insert(pair.spelled_out.tasks.begin() + at, rows);
  rows.a.setConstant(NAN);
  rows.is_motion = true;
  pair.marked.tasks.insert(pair.marked.tasks.begin() + at, rows);
  pair.marked.motion_is_y = motion_is_y;
  return pair;
}

template <typename Law>
void check_marks() {
  for (int seed = 0; seed < 200; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const Pair pair = random_pair(random, seed % 2 == 0);
      const Vector marked = solve<Law>(pair.marked, select_all_tasks(pair.marked));
      const Vector expected = solve<Law>(pair.spelled_out, select_all_tasks(pair.spelled_out));
      BOOST_TEST((marked - expected).norm() <= 1e-9 * (1.0 + expected.norm()));
    }
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(unilateral_takes_marks_for_rows) { check_marks<Unilateral>(); }
BOOST_AUTO_TEST_CASE(hierarchy_takes_marks_for_rows) { check_marks<Hierarchy>(); }

BOOST_AUTO_TEST_CASE(hierarchy_follows_any_sequence_of_limit_rows) {
  for (int seed = 0; seed < 50; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      RandomStackOptions options;
      options.n = random.integer(4, 12);
      options.weak = 0.2;
      const Stack stack = random_stack(random, options);
      Hierarchy law(stack, {});
      law.begin();
      Selection selection = select_all_tasks(stack);
      Vector target = stack.limit_target;
      Solution solution(stack.size());
      for (int step = 0; step < 20; ++step) {  // rows come, go, and change what they ask for
        const auto joint = static_cast<std::size_t>(random.integer(0, options.n - 1));
        selection.limits[joint] = random.chance(0.6) ? 1 : 0;
        if (random.chance(0.2)) {
          target[static_cast<Eigen::Index>(joint)] += 0.1;
        }
        law.solve(stack, selection, target, solution);
        Hierarchy fresh(stack, {});
        Solution expected(stack.size());
        fresh.begin();
        fresh.solve(stack, selection, target, expected);
        BOOST_TEST((solution.y - expected.y).norm() <= 1e-9 * (1.0 + expected.y.norm()));
        BOOST_TEST((solution.y_limits - expected.y_limits).norm() <=
                   1e-10 * (1.0 + expected.y_limits.norm()));
      }
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
