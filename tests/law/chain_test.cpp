// Chain: the Lovasz extension by its integral form, vertices, one transition, exactness and priority with
// transitions under way, continuity across ties, and the number of laws. Over Hierarchy and, for task
// changes, over Unilateral. Not here: its inputs, the activations by state (limit room).
#include "support/infinity_norm.hpp"
#include "support/path.hpp"
#include "support/phi.hpp"
#include "support/random_stack.hpp"

#include <tope/law/chain.hpp>
#include <tope/law/hierarchy.hpp>
#include <tope/law/unilateral.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(chain)
namespace {

const Hierarchy::Options defaults;

Solution chain_solution(const Stack& stack) {
  Hierarchy law(stack, defaults);
  Chain blend(stack);
  Solution solution(stack.size());
  blend.solve(stack, stack.limit_activation, law, solution);
  return solution;
}

Vector chain_command(const Stack& stack) { return chain_solution(stack).y; }

/// Elements whose activation is at least `threshold`.
Selection level_set(const Stack& stack, double threshold) {
  Selection selection(stack);
  for (std::size_t j = 0; j < selection.limits.size(); ++j) {
    selection.limits[j] = stack.limit_activation[static_cast<Eigen::Index>(j)] >= threshold ? 1 : 0;
  }
  for (std::size_t i = 0; i < selection.tasks.size(); ++i) {
    selection.tasks[i] = stack.tasks[i].activation >= threshold ? 1 : 0;
  }
  return selection;
}

/// The integral over thresholds in (0, 1] of phi(level set): another way to write the chain.
Vector lovasz_integral(const Stack& stack) {
  std::set<double> thresholds{0.0, 1.0};
  thresholds.insert(stack.limit_activation.begin(), stack.limit_activation.end());
  for (const TaskRows& task : stack.tasks) {
    thresholds.insert(task.activation);
  }
  Vector y = Vector::Zero(stack.size());
  for (auto low = thresholds.begin(); std::next(low) != thresholds.end(); ++low) {
    y += (*std::next(low) - *low) * phi(stack, level_set(stack, *std::next(low)));
  }
  return y;
}

RandomStackOptions random_options(Random& random) {
  RandomStackOptions options;
  options.n = random.integer(3, 20);
  options.levels = random.integer(1, 3);
  options.limit_transitions = random.integer(0, std::min(4, options.n));
  options.task_transitions = random.integer(0, 2);
  return options;
}

}  // namespace

BOOST_AUTO_TEST_CASE(equals_its_integral_form) {
  for (int seed = 0; seed < 200; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const Stack stack = random_stack(random, random_options(random));
      BOOST_TEST(infinity_norm(chain_command(stack) - lovasz_integral(stack)) <=
                 1e-12 * (1.0 + lovasz_integral(stack).norm()));
    }
  }
}

BOOST_AUTO_TEST_CASE(equals_phi_at_every_vertex) {
  Random random(1);
  Stack stack = random_stack(random, {.n = 5, .levels = 3, .complete_limits = 0.0, .deficient = 0.0});
  const std::size_t tasks = stack.tasks.size();
  for (std::size_t vertex = 0; vertex < std::size_t{1} << (5 + tasks); ++vertex) {
    for (std::size_t j = 0; j < 5; ++j) {
      stack.limit_activation[static_cast<Eigen::Index>(j)] = static_cast<double>(vertex >> j & 1U);
    }
    for (std::size_t i = 0; i < tasks; ++i) {
      stack.tasks[i].activation = static_cast<double>(vertex >> (5 + i) & 1U);
    }
    const Solution solution = chain_solution(stack);
    BOOST_TEST(infinity_norm(solution.y - phi(stack, select_complete(stack))) == 0.0);
    BOOST_TEST(solution.laws == 1);
  }
}

// A task is complete at its old level or at its new one, never half gone: what is not selected is erased here.
BOOST_AUTO_TEST_CASE(blends_a_task_and_what_replaces_it) {
  for (int seed = 0; seed < 100; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      RandomStackOptions options = random_options(random);
      options.limit_transitions = options.task_transitions = 0;
      Stack stack = random_stack(random, options);
      const int count = static_cast<int>(stack.tasks.size());
      if (count < 2) {
        continue;
      }
      const auto replaced = static_cast<std::size_t>(random.integer(0, count - 1));
      const auto replacement =
          (replaced + static_cast<std::size_t>(random.integer(1, count - 1))) % stack.tasks.size();
      const auto without = [](Stack rest, std::size_t task) {
        rest.tasks.erase(rest.tasks.begin() + static_cast<std::ptrdiff_t>(task));
        return phi(rest, select_complete(rest));
      };
      const Vector before = without(stack, replacement);
      const Vector after = without(stack, replaced);
      stack.tasks[replaced].replaced_by = static_cast<int>(replacement);
      for (const double xi : {0.0, random.uniform(0.01, 0.99), 1.0}) {
        stack.tasks[replacement].activation = xi;
        const Vector expected = (1.0 - xi) * before + xi * after;
        BOOST_TEST(infinity_norm(chain_command(stack) - expected) <= 1e-12 * (1.0 + expected.norm()));
      }
    }
  }
}

// The task on level 1 moves to level 2 and, before it is there, to level 3.
BOOST_AUTO_TEST_CASE(blends_a_second_replacement_under_way) {
  Random random(5);
  Stack stack = random_stack(random, {.n = 8, .levels = 3, .complete_limits = 0.0, .deficient = 0.0});
  stack.tasks.clear();
  for (int level = 1; level <= 3; ++level) {
    stack.tasks.push_back({.level = level, .a = random.matrix(3, 8), .b = random.vector(3)});
  }
  const auto alone = [&](std::size_t task) {
    Selection selection(stack);
    selection.tasks[task] = 1;
    return phi(stack, selection);
  };
  stack.tasks[0].replaced_by = 1;
  stack.tasks[1].replaced_by = 2;
  const auto check = [&](double second, double third, const Vector& expected) {
    stack.tasks[1].activation = second;
    stack.tasks[2].activation = third;
    BOOST_TEST(infinity_norm(chain_command(stack) - expected) <= 1e-12);
  };
  check(0.7, 0.2, 0.3 * alone(0) + 0.5 * alone(1) + 0.2 * alone(2));
  check(0.3, 0.6, 0.4 * alone(0) + 0.6 * alone(2));  // the third enters before the second
  check(1.0, 0.6, 0.4 * alone(1) + 0.6 * alone(2));
}

BOOST_AUTO_TEST_CASE(is_the_convex_combination_for_one_transition) {
  for (int seed = 0; seed < 50; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      RandomStackOptions options = random_options(random);
      options.limit_transitions = seed % 2;
      options.task_transitions = 1 - seed % 2;
      const Stack stack = random_stack(random, options);
      const Selection with = level_set(stack, 1e-6);
      const Selection without = level_set(stack, 1.0);
      double xi = 0.0;
      for (const double activation : stack.limit_activation) {
        xi = activation < 1.0 ? std::max(xi, activation) : xi;
      }
      for (const TaskRows& task : stack.tasks) {
        xi = task.activation < 1.0 ? task.activation : xi;
      }
      const Vector expected = (1.0 - xi) * phi(stack, without) + xi * phi(stack, with);
      BOOST_TEST(infinity_norm(chain_command(stack) - expected) <= 1e-12 * (1.0 + expected.norm()));
    }
  }
}

BOOST_AUTO_TEST_CASE(meets_complete_limit_rows) {
  double largest = 0.0;
  for (int seed = 0; seed < 300; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      RandomStackOptions options = random_options(random);
      options.n = random.integer(3, 40);
      options.complete_limits = 0.4;
      const Stack stack = random_stack(random, options);
      const Vector miss = stack.motion * chain_command(stack) - stack.limit_target;
      for (int j = 0; j < stack.size(); ++j) {
        if (stack.limit_activation[j] == 1.0) {
          BOOST_TEST(std::abs(miss[j]) <= 1e-10);
          largest = std::max(largest, std::abs(miss[j]));
        }
      }
    }
  }
  BOOST_TEST_MESSAGE("largest miss " << largest);
}

BOOST_AUTO_TEST_CASE(keeps_priority_during_transitions) {
  double largest = 0.0;
  for (int seed = 0; seed < 200; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      // level 1 is complete, with room beside all limit rows; levels 2 and 3 come and go
      Random random(seed);
      RandomStackOptions options;
      options.n = random.integer(8, 40);
      options.limit_transitions = 2;
      options.complete_limits = 0.0;
      options.deficient = 0.0;
      Stack stack = random_stack(random, options);
      for (TaskRows& task : stack.tasks) {
        task.activation = task.level == 1 ? 1.0 : random.uniform(0.1, 0.9);
        task.a = task.level == 1 ? task.a.topRows(1).eval() : task.a;
        task.b = task.level == 1 ? task.b.head(1).eval() : task.b;
      }
      const Stack alone = truncated(stack, 1);
      const Solution with = chain_solution(stack);
      for (const TaskRows& task : alone.tasks) {
        const double change = infinity_norm(task.a * (with.y - chain_command(alone)));
        BOOST_TEST(change <= 1e-9);
        largest = std::max(largest, change);
      }
    }
  }
  BOOST_TEST_MESSAGE("largest change of level 1 " << largest);
}

BOOST_AUTO_TEST_CASE(counts_one_law_for_each_distinct_value) {
  Random random(2);
  Stack stack = random_stack(random, {.n = 6, .levels = 2, .complete_limits = 0.0});
  stack.limit_activation << 0.0, 0.3, 0.3, 0.7, 1.0, 0.0;
  BOOST_TEST(chain_solution(stack).laws == 3);
  stack.tasks.back().activation = 0.5;
  BOOST_TEST(chain_solution(stack).laws == 4);
}

BOOST_AUTO_TEST_CASE(is_continuous_across_ties) {
  for (int seed = 0; seed < 50; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      Stack stack =
          random_stack(random, {.n = 8, .levels = 2, .limit_transitions = 3, .complete_limits = 0.0});
      const double tie = random.uniform(0.2, 0.8);
      std::vector<Eigen::Index> rows;
      for (Eigen::Index j = 0; j < 8; ++j) {
        if (stack.limit_activation[j] > 0.0) {
          rows.push_back(j);
        }
      }
      stack.tasks.back().activation = tie;
      const auto command = [&](double a, double b) {
        stack.limit_activation[rows[0]] = tie + a;
        stack.limit_activation[rows[1]] = tie + b;
        return chain_command(stack);
      };
      const Vector at_tie = command(0.0, 0.0);
      for (const double step : {1e-3, 1e-6, 1e-9}) {
        for (const auto& [a, b] : {std::pair{step, -step}, {-step, step}, {step, step}, {0.0, -step}}) {
          BOOST_TEST(infinity_norm(command(a, b) - at_tie) <= 100.0 * step);
        }
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(is_continuous_along_smooth_paths) {
  for (int seed = 0; seed < 10; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const StackPath path(random, 6, seed % 2 == 0);
      const auto over_hierarchy = [&](double s) { return chain_command(path.at(s)); };
      check_continuity(over_hierarchy);
      const auto over_unilateral = [&](double s) {
        const Stack stack = path.at(s);
        Unilateral law(stack, {});
        Chain blend(stack);
        Solution solution(stack.size());
        blend.solve(stack, Vector::Zero(stack.size()), law, solution);
        return solution.y;
      };
      check_continuity(over_unilateral);
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
