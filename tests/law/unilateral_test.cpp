// Unilateral: the optimality conditions of every level and a dense reference with eiquadprog on random
// stacks, half of them with inequality rows; bounds, priority, the level of the limits alone, continuity. Not here: its behaviour in closed loop
// (controller room).
#include "support/infinity_norm.hpp"
#include "support/kkt.hpp"
#include "support/path.hpp"
#include "support/random_stack.hpp"
#include "support/reference_unilateral.hpp"
#include "support/text.hpp"

#include <tope/law/unilateral.hpp>

#include <Eigen/QR>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(unilateral)
namespace {

const Unilateral::Options defaults;

Solution solve(const Stack& stack, const Unilateral::Options& options = defaults) {
  Unilateral law(stack, options);
  Solution solution(stack.size());
  law.solve(stack, select_all_tasks(stack), solution);
  return solution;
}

/// Calls `check` with random stacks; deficient ranks, directions that are nearly lost and states beyond a
/// limit are among them.
template <typename Check>
void on_random_stacks(int seeds, Check check) {
  for (int seed = 0; seed < seeds; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      RandomStackOptions options;
      options.n = random.integer(3, 40);
      options.levels = random.integer(1, 4);
      options.beyond = random.chance(0.3);
      options.weak = 0.2;
      options.inequalities = random.chance(0.5) ? random.integer(1, 2 * options.n) : 0;
      check(random_stack(random, options));
    }
  }
}

/// Level 0 as its definition says: y over s / softness.
KktResidual limit_level_residual(const Stack& stack, const ReferenceLevel& level, const Vector& y) {
  const Eigen::Index n = stack.size();
  const Eigen::Index p = stack.inequality.rows();
  Matrix rows = Matrix::Zero(n + p, n + p);
  rows.leftCols(n) = bounded_rows(stack);
  rows.bottomRightCorner(p, p).diagonal().setConstant(defaults.softness);
  Vector both(n + p);
  both << y, (level.lower.tail(p) - stack.inequality * y).cwiseMax(0.0) / defaults.softness;
  return kkt_residual(Matrix(0, n + p), Vector(0), 1.0, rows, level.lower, level.upper, both, 1e-8);
}

}  // namespace

BOOST_AUTO_TEST_CASE(equals_dense_reference) {
  double largest = 0.0;
  on_random_stacks(200, [&](const Stack& stack) {
    const Solution solution = solve(stack);
    BOOST_TEST(!solution.cut_off);
    const auto levels = reference_unilateral(stack, select_all_tasks(stack), defaults);
    const double error = infinity_norm(solution.y - levels.back().y);
    BOOST_TEST(error <= 1e-8);
    BOOST_TEST(infinity_norm(solution.y_limits - levels.front().y) <= 1e-8);
    largest = std::max(largest, error);
  });
  BOOST_TEST_MESSAGE("largest deviation " << largest);
}

BOOST_AUTO_TEST_CASE(every_level_is_optimal) {
  KktResidual worst;
  on_random_stacks(100, [&](const Stack& stack) {
    // the library's own answer after each level, from the stack cut off below it
    Vector above = Vector::Zero(stack.size());
    for (const ReferenceLevel& level : reference_unilateral(stack, select_all_tasks(stack), defaults)) {
      const Vector y = solve(truncated(stack, level.level)).y;
      Eigen::CompleteOrthogonalDecomposition<Matrix> open(level.open.rows(), level.open.cols());
      open.setThreshold(1e-9);
      const Vector z = open.compute(level.open).solve(y - above);
      BOOST_TEST(infinity_norm(level.open * z - (y - above)) <= 1e-9);
      const Matrix bounded = bounded_rows(stack);
      const Vector now = bounded * above;
      const KktResidual kkt = level.level == 0 ? limit_level_residual(stack, level, y)
                                               : kkt_residual(level.a * level.open, level.b - level.a * above,
                                                              level.mu, bounded * level.open,
                                                              level.lower - now, level.upper - now, z, 1e-8);
      BOOST_TEST(kkt.feasibility <= 1e-8);
      BOOST_TEST(kkt.stationarity <= 1e-8);
      worst.feasibility = std::max(worst.feasibility, kkt.feasibility);
      worst.stationarity = std::max(worst.stationarity, kkt.stationarity);
      above = y;
    }
  });
  BOOST_TEST_MESSAGE("beyond a bound " << worst.feasibility << ", stationarity " << worst.stationarity);
}

BOOST_AUTO_TEST_CASE(takes_levels_with_more_rows_than_unknowns) {
  for (int seed = 0; seed < 20; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      Stack stack = random_stack(random, {.n = 5, .levels = 3});
      stack.tasks.push_back(
          {.level = 3, .activation = 1.0, .a = Matrix::Identity(5, 5), .b = random.vector(5)});
      stack.tasks.push_back({.level = 3, .activation = 1.0, .a = random.matrix(9, 5), .b = random.vector(9)});
      stack.tasks.push_back({.level = 4, .activation = 1.0, .a = random.matrix(2, 5), .b = random.vector(2)});
      const auto levels = reference_unilateral(stack, select_all_tasks(stack), defaults);
      BOOST_TEST(infinity_norm(solve(stack).y - levels.back().y) <= 1e-8);
    }
  }
}

BOOST_AUTO_TEST_CASE(bounds_hold) {
  on_random_stacks(200, [](const Stack& stack) {
    const Vector motion = stack.motion * solve(stack).y;
    BOOST_TEST((motion - stack.motion_upper).maxCoeff() <= 0.0);
    BOOST_TEST((stack.motion_lower - motion).maxCoeff() <= 0.0);
  });
}

BOOST_AUTO_TEST_CASE(bounds_hold_against_any_demand) {
  on_random_stacks(100, [](Stack stack) {
    for (TaskRows& task : stack.tasks) {
      task.b *= 1e6;
    }
    const Solution solution = solve(stack);
    const Vector motion = stack.motion * solution.y;
    BOOST_TEST(!solution.cut_off);
    BOOST_TEST((motion - stack.motion_upper).maxCoeff() <= 0.0);
    BOOST_TEST((stack.motion_lower - motion).maxCoeff() <= 0.0);
  });
}

/// Every row is kept as far as level 0 keeps it, whatever the tasks ask.
BOOST_AUTO_TEST_CASE(inequality_rows_hold_against_any_demand) {
  int pressed = 0;
  on_random_stacks(200, [&](Stack stack) {
    const Selection none(stack);
    const Vector slack = reference_unilateral(stack, none, defaults).front().slack;
    for (TaskRows& task : stack.tasks) {
      task.b *= 1e3;
    }
    const Vector room = stack.inequality * solve(stack).y - (stack.inequality_lower - slack);
    for (const double value : room) {
      BOOST_TEST(value >= 0.0);
      pressed += value < defaults.inequality_headroom ? 1 : 0;
    }
  });
  BOOST_TEST(pressed >= 500);
  BOOST_TEST_MESSAGE(pressed << " rows pressed");
}

/// Two joints: a row that the joints can meet, one that they cannot, one that nothing moves.
BOOST_AUTO_TEST_CASE(inequality_rows_ask_for_motion_and_yield_to_the_joints) {
  Stack stack(2, 3);
  stack.motion_lower.setConstant(-1.0);
  stack.motion_upper.setConstant(1.0);
  stack.inequality << 2.0, 0.0, 0.0, 1.0, 0.0, 0.0;
  stack.inequality_lower << 0.5, 3.0, 4.0;
  stack.tasks.push_back(
      {.level = 1, .activation = 1.0, .a = Matrix::Identity(2, 2), .b = Vector::Constant(2, -9.0)});
  Unilateral law(stack, defaults);
  Solution solution(2);
  law.solve(stack, select_all_tasks(stack), solution);
  const double met = (0.5 + defaults.inequality_headroom) / 2.0;
  BOOST_TEST(std::abs(solution.y_limits[0] - met) <= std::pow(defaults.softness, 2) * met);
  BOOST_TEST(std::abs(solution.y_limits[1] - (1.0 - defaults.headroom)) <= 1e-10);
  // the task asks for the contrary, and gets what the headroom of its level is less than that of level 0
  BOOST_TEST(std::abs(solution.y[0] - (solution.y_limits[0] - 0.25 * defaults.inequality_headroom)) <= 1e-10);
  BOOST_TEST(std::abs(solution.y[1] - (solution.y_limits[1] - 0.5 * defaults.inequality_headroom)) <= 1e-10);
}

BOOST_AUTO_TEST_CASE(idle_inequality_rows_change_nothing) {
  on_random_stacks(50, [](const Stack& stack) {
    Stack idle(stack.size(), 3);
    idle.motion = stack.motion;
    idle.motion_lower = stack.motion_lower;
    idle.motion_upper = stack.motion_upper;
    idle.tasks = stack.tasks;
    idle.inequality.setOnes();
    idle.inequality_lower.setConstant(-1e3);
    Stack bare = idle;
    bare.inequality.resize(0, stack.size());
    bare.inequality_lower.resize(0);
    BOOST_TEST(infinity_norm(solve(idle).y - solve(bare).y) <= 1e-9);
  });
}

BOOST_AUTO_TEST_CASE(lower_levels_leave_higher_ones_alone) {
  double largest = 0.0;
  int checked = 0;
  on_random_stacks(200, [&](const Stack& stack) {
    const Vector y = solve(stack).y;
    for (const ReferenceLevel& level : reference_unilateral(stack, select_all_tasks(stack), defaults)) {
      // exact where every direction is held (sigma >= lock) or lost altogether
      const auto between = level.singular.array() > 1e-9 && level.singular.array() < defaults.lock;
      if (level.level == 0 || between.any()) {
        continue;
      }
      const Vector alone = solve(truncated(stack, level.level)).y;
      const double change = infinity_norm(level.a * (y - alone));
      BOOST_TEST(change <= 1e-9);
      largest = std::max(largest, change);
      ++checked;
    }
  });
  BOOST_TEST(checked >= 200);
  BOOST_TEST_MESSAGE(checked << " levels, largest change of a higher level " << largest);
}

BOOST_AUTO_TEST_CASE(without_tasks_takes_the_shortest_command_inside_the_bounds) {
  Stack stack(3);
  stack.motion_lower << -1.0, 0.2, -2.0;
  stack.motion_upper << 1.0, 1.0, -0.5;
  Unilateral law(stack, defaults);
  Solution solution(3);
  law.solve(stack, Selection(stack), solution);
  const Vector expected = (Vector(3) << 0.0, 0.2 + defaults.headroom, -0.5 - defaults.headroom).finished();
  BOOST_TEST(infinity_norm(solution.y - expected) <= 1e-10);
  BOOST_TEST(infinity_norm(solution.y_limits - expected) <= 1e-10);
}

BOOST_AUTO_TEST_CASE(takes_infinite_bounds) {
  Random random(7);
  Stack stack = random_stack(random, {.n = 6, .levels = 2, .deficient = 0.0});
  stack.motion_lower.setConstant(-INFINITY);
  stack.motion_upper.setConstant(INFINITY);
  const Solution solution = solve(stack);
  BOOST_TEST(!solution.cut_off);
  // the first level is damped least squares, and the second leaves it alone
  const ReferenceLevel first = reference_unilateral(stack, select_all_tasks(stack), defaults)[1];
  const Matrix damped = first.a.transpose() * first.a + first.mu * Matrix::Identity(6, 6);
  const Vector expected = first.a * damped.ldlt().solve(first.a.transpose() * first.b);
  BOOST_TEST(infinity_norm(first.a * solution.y - expected) <= 1e-9);
}

BOOST_AUTO_TEST_CASE(limit_rows_have_no_part) {
  Random random(8);
  Stack stack = random_stack(random, {.n = 8, .levels = 2});
  const Vector y = solve(stack).y;
  stack.limit_activation.setOnes();
  stack.limit_target.setConstant(9.0);
  BOOST_TEST(infinity_norm(solve(stack).y - y) == 0.0);
}

BOOST_AUTO_TEST_CASE(is_continuous_along_smooth_paths) {
  for (int seed = 0; seed < 50; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const StackPath path(random, 6, seed % 2 == 0);
      check_continuity([&](double s) { return solve(path.at(s)).y; });
    }
  }
}

BOOST_AUTO_TEST_CASE(is_continuous_along_smooth_paths_with_inequality_rows) {
  for (int seed = 0; seed < 50; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const StackPath path(random, 6, seed % 2 == 0, 4);
      check_continuity([&](double s) { return solve(path.at(s)).y; });
    }
  }
}

BOOST_AUTO_TEST_CASE(refuses_bad_options) {
  const Stack stack(2);
  const auto refuse = [&](double Unilateral::Options::* member, double value, const std::string& name) {
    Unilateral::Options bad;
    bad.*member = value;
    check_error([&] { const Unilateral law(stack, bad); }, {"unilateral: " + name});
  };
  refuse(&Unilateral::Options::damping, 0.0, "damping must be positive");
  refuse(&Unilateral::Options::fine_damping, -0.1, "fine_damping must be positive");
  refuse(&Unilateral::Options::fine_below, 0.0, "fine_below must be positive");
  refuse(&Unilateral::Options::lock, -0.1, "lock must be positive");
  refuse(&Unilateral::Options::headroom, NAN, "headroom must be positive");
  refuse(&Unilateral::Options::headroom, INFINITY, "headroom must be positive");
  refuse(&Unilateral::Options::softness, 0.0, "softness must be positive");
  refuse(&Unilateral::Options::inequality_headroom, 0.0, "inequality_headroom must be positive");
  refuse(&Unilateral::Options::fine_damping, 0.5, "fine_damping 0.500000 must not exceed damping");
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
