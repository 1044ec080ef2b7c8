// Hierarchy against a dense reference on random stacks, what it promises (rows met, priority kept), its
// damping by formula, and continuity through singularities. Not here: blends of it (chain_test,
// multilinear_test).
#include "support/path.hpp"
#include "support/random_stack.hpp"
#include "support/reference_hierarchy.hpp"
#include "support/text.hpp"

#include <tope/law/hierarchy.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(hierarchy)
namespace {

const Hierarchy::Options defaults;

Vector solve(const Stack& stack, const Selection& selection, const Hierarchy::Options& options = defaults) {
  Hierarchy hierarchy(stack, options);
  Solution solution(stack.size());
  hierarchy.solve(stack, selection, solution);
  return solution.y;
}

double deviation(const Vector& a, const Vector& b) { return (a - b).lpNorm<Eigen::Infinity>(); }

RandomStackOptions random_options(Random& random) {
  RandomStackOptions options;
  options.n = random.integer(3, 40);
  options.levels = random.integer(1, 4);
  return options;
}

/// Calls `check` on random stacks away from singularities; counts them.
template <typename Check>
int on_regular_stacks(int seeds, Check check) {
  int checked = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const Stack stack = random_stack(random, random_options(random));
      const Selection selection = select_all_tasks(stack);
      const ReferenceHierarchy reference = reference_hierarchy(stack, selection, defaults.epsilon);
      if (reference.smallest_share > defaults.damped_below) {
        ++checked;
        check(stack, selection, reference);
      }
    }
  }
  return checked;
}

/// Two unknowns, one row: A = (a, 0), b = 1.
Stack one_row_stack(double a, int level = 1) {
  Stack stack(2);
  Matrix row = Matrix::Zero(1, 2);
  row(0, 0) = a;
  stack.tasks.push_back({.level = level, .activation = 1.0, .a = row, .b = Vector::Ones(1)});
  return stack;
}

}  // namespace

BOOST_AUTO_TEST_CASE(equals_dense_reference_away_from_singularities) {
  double largest = 0.0;
  const int checked =
      on_regular_stacks(400, [&](const Stack& stack, const Selection& selection, const auto& reference) {
        const double error = deviation(solve(stack, selection), reference.y);
        BOOST_TEST(error <= 1e-9);
        largest = std::max(largest, error);
      });
  BOOST_TEST(checked >= 100);
  BOOST_TEST_MESSAGE(checked << " stacks, largest deviation " << largest);
}

BOOST_AUTO_TEST_CASE(meets_limit_rows_exactly) {
  on_regular_stacks(200, [](const Stack& stack, const Selection& selection, const auto&) {
    const Vector motion = stack.motion * solve(stack, selection);
    for (int j = 0; j < stack.size(); ++j) {
      if (selection.limits[static_cast<std::size_t>(j)] != 0) {
        BOOST_TEST(std::abs(motion[j] - stack.limit_target[j]) <= 1e-10);
      }
    }
  });
}

BOOST_AUTO_TEST_CASE(lower_levels_leave_higher_ones_alone) {
  double largest = 0.0;
  on_regular_stacks(200, [&](const Stack& stack, const Selection& selection, const auto&) {
    const Vector complete = solve(stack, selection);
    for (int level = 1; level < stack.tasks.back().level; ++level) {
      const Stack above = truncated(stack, level);
      const Vector alone = solve(above, select_all_tasks(above));
      const Matrix a = level_matrix(stack, selection, level);
      const double change = deviation(a * alone, a * complete);
      BOOST_TEST(change <= 1e-9);
      largest = std::max(largest, change);
    }
  });
  BOOST_TEST_MESSAGE("largest change of a higher level " << largest);
}

BOOST_AUTO_TEST_CASE(unselected_tasks_have_no_part) {
  Random random(1);
  const Stack stack = random_stack(random, {.n = 9, .levels = 3});
  Selection none = select_complete(stack);
  std::fill(none.tasks.begin(), none.tasks.end(), 0);
  std::fill(none.limits.begin(), none.limits.end(), 0);
  BOOST_TEST(solve(stack, none).norm() == 0.0);
}

BOOST_AUTO_TEST_CASE(splits_the_limits_part_off) {
  Random random(2);
  const Stack stack = random_stack(random, {.n = 9, .levels = 2, .complete_limits = 0.5});
  Selection selection = select_all_tasks(stack);
  Hierarchy law(stack, defaults);
  Solution solution(9);
  law.solve(stack, selection, solution);
  const Vector part = solution.y_limits;
  std::fill(selection.tasks.begin(), selection.tasks.end(), 0);
  law.solve(stack, selection, solution);
  BOOST_TEST(deviation(part, solution.y) <= 1e-14);
  BOOST_TEST(solution.y.norm() > 0.0);
}

BOOST_AUTO_TEST_CASE(damps_by_its_formula) {
  // one row (a, 0): rho = a^2 / (a^2 + eps^2)
  const double epsilon = defaults.epsilon;
  const double rho_0 = defaults.damped_below;
  for (const double rho : {1e-6, 0.01, 0.03, 0.0499, 0.0501, 0.3}) {
    const double a = epsilon * std::sqrt(rho / (1.0 - rho));
    const double gain = rho / (rho + rho_0 * std::pow(std::max(0.0, 1.0 - rho / rho_0), 2));
    const Stack stack = one_row_stack(a);
    Hierarchy law(stack, defaults);
    Solution solution(2);
    law.solve(stack, select_complete(stack), solution);
    BOOST_TEST(a * solution.y[0] == gain, boost::test_tools::tolerance(1e-9));
    BOOST_TEST(solution.singular == (rho < rho_0));
  }
}

BOOST_AUTO_TEST_CASE(hands_a_lost_direction_down_by_its_formula) {
  // the second level finds the open share 1 - s(rho / rho_lock) of the only direction
  for (const double rho : {0.002, 0.01, 0.019, 0.021}) {
    const double epsilon = defaults.epsilon;
    const double a = epsilon * std::sqrt(rho / (1.0 - rho));
    Stack stack = one_row_stack(a);
    stack.tasks[0].b[0] = 0.0;
    const double x = std::min(1.0, rho / defaults.locked_above);
    const double open = 1.0 - x * x * (3.0 - 2.0 * x);
    stack.tasks.push_back(one_row_stack(1.0, 2).tasks[0]);
    const double share = open / (1.0 + epsilon * epsilon);
    const double deficit = std::max(0.0, 1.0 - share / defaults.damped_below);
    const double expected = share / (share + defaults.damped_below * deficit * deficit);
    BOOST_TEST(std::abs(solve(stack, select_complete(stack))[0] - expected) <= 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(is_continuous_through_singularities) {
  for (int seed = 0; seed < 50; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const StackPath path(random, 6, true);
      const auto command = [&](double s) {
        const Stack stack = path.at(s);
        Selection selection = select_all_tasks(stack);
        std::fill(selection.limits.begin(), selection.limits.end(), 0);
        selection.limits[0] = 1;
        return solve(stack, selection);
      };
      check_continuity(command);
    }
  }
}

/// A stack of which some joints move no row of some tasks; half of them as velocity mode has it, with a posture below.
Stack sparse_stack(Random& random) {
  Stack stack = random_stack(random, {.n = random.integer(4, 14),
                                      .levels = random.integer(1, 3),
                                      .task_transitions = random.integer(0, 1),
                                      .complete_limits = 0.1,
                                      .weak = 0.2});
  for (TaskRows& task : stack.tasks) {
    for (int j = 0; j < stack.size(); ++j) {
      if (random.chance(0.3)) {
        task.a.col(j).setZero();
      }
    }
  }
  if (random.chance(0.5)) {
    stack.motion.setIdentity();
    stack.motion_is_y = true;
    stack.tasks.push_back({.level = stack.tasks.back().level + 1,
                           .a = stack.motion,
                           .b = random.vector(stack.size()),
                           .is_motion = true});
  }
  return stack;
}

BOOST_AUTO_TEST_CASE(what_a_selection_leaves_to_the_next_changes_nothing) {
  int singular = 0;
  int all = 0;
  double largest = 0.0;
  for (int seed = 0; seed < 1000; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const Stack stack = sparse_stack(random);
      Selection selection = select_all_tasks(stack);
      Hierarchy law(stack, defaults);
      law.begin();
      Solution solution(stack.size());
      for (int step = 0; step < 8; ++step) {
        law.solve(stack, selection, solution);
        const Vector fresh = solve(stack, selection);
        const double error = deviation(solution.y, fresh) / (1.0 + fresh.norm());
        BOOST_TEST(error <= 1e-9);
        largest = std::max(largest, error);
        singular += solution.singular ? 1 : 0;
        ++all;
        if (random.chance(0.1)) {  // what follows shares nothing with it
          char& task = selection.tasks[static_cast<std::size_t>(
              random.integer(0, static_cast<int>(selection.tasks.size()) - 1))];
          task = task != 0 ? 0 : 1;
        }
        for (int i = random.integer(0, 2); i > 0; --i) {
          selection.limits[static_cast<std::size_t>(random.integer(0, stack.size() - 1))] = 1;
        }
      }
    }
  }
  BOOST_TEST(singular > all / 10);
  BOOST_TEST(singular < 9 * all / 10);
  BOOST_TEST_MESSAGE(singular << " of " << all << " singular, largest deviation " << largest);
}

BOOST_AUTO_TEST_CASE(refuses_bad_options) {
  const Stack stack(2);
  for (const Hierarchy::Options& bad :
       {Hierarchy::Options{.damped_below = 0.01, .locked_above = 0.02, .epsilon = 0.1},
        Hierarchy::Options{.damped_below = 1.0, .locked_above = 0.02, .epsilon = 0.1},
        Hierarchy::Options{.damped_below = 0.05, .locked_above = -0.02, .epsilon = 0.1},
        Hierarchy::Options{.damped_below = 0.05, .locked_above = 0.02, .epsilon = 0.0},
        Hierarchy::Options{.damped_below = NAN, .locked_above = 0.02, .epsilon = 0.1}}) {
    check_error([&] { const Hierarchy law(stack, bad); },
                {"hierarchy", "0 < locked_above < damped_below < 1"});
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
