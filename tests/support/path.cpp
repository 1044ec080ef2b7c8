#include "support/path.hpp"

#include <Eigen/Cholesky>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tope::test {
namespace {

struct Step {
  double begin;
  double change;
};

std::vector<Step> all_steps(const std::function<Vector(double)>& f, double begin, double width, int steps) {
  std::vector<Step> all;
  Vector last = f(begin);
  for (int i = 1; i <= steps; ++i) {
    const Vector now = f(begin + width * i / steps);
    all.push_back(
        {.begin = begin + width * (i - 1) / steps, .change = (now - last).lpNorm<Eigen::Infinity>()});
    last = now;
  }
  return all;
}

bool changes_less(const Step& a, const Step& b) { return a.change < b.change; }

Step largest_step(const std::function<Vector(double)>& f, double begin, double width, int steps) {
  const std::vector<Step> all = all_steps(f, begin, width, steps);
  return *std::max_element(all.begin(), all.end(), changes_less);
}

}  // namespace

std::vector<double> zoomed_changes(const std::function<Vector(double)>& f, int steps, int rounds) {
  constexpr std::size_t followed = 50;
  std::vector<Step> coarse = all_steps(f, 0.0, 1.0, steps);
  std::sort(coarse.rbegin(), coarse.rend(), changes_less);
  std::vector<double> largest(static_cast<std::size_t>(rounds) + 1, 0.0);
  largest[0] = coarse[0].change;
  for (std::size_t i = 0; i < followed; ++i) {
    Step step = coarse[i];
    double width = 1.0 / steps;
    for (std::size_t round = 1; round < largest.size(); ++round) {
      step = largest_step(f, step.begin, width, 10);
      width /= 10.0;
      largest[round] = std::max(largest[round], step.change);
    }
  }
  return largest;
}

void check_continuity(const std::function<Vector(double)>& f) {
  constexpr std::size_t rounds = 6;
  const std::vector<double> changes = zoomed_changes(f, 1000, rounds);
  BOOST_TEST(changes[rounds - 1] >= 8.0 * changes[rounds]);
  BOOST_TEST(changes[rounds] <= 1e-3 * changes[0]);
  BOOST_TEST_MESSAGE("steepest slope " << changes[rounds] * 1e9 << ", ratio "
                                       << changes[rounds - 1] / changes[rounds]);
}

StackPath::Curve StackPath::curve(Random& random, Eigen::Index rows, Eigen::Index cols, double size) {
  const auto m = static_cast<int>(rows);
  const auto n = static_cast<int>(cols);
  return {.centre = size * random.matrix(m, n),
          .amplitude = size * random.matrix(m, n),
          .frequency = random.uniform(0.3, 1.0),
          .phase = random.uniform(0.0, 2.0 * std::numbers::pi)};
}

Matrix StackPath::Curve::at(double s) const {
  return centre + std::sin(2.0 * std::numbers::pi * frequency * s + phase) * amplitude;
}

StackPath::StackPath(Random& random, int n, bool rank_changing, int inequalities)
    : n_(n),
      rank_changing_(rank_changing),
      motion_(random.positive_definite(n, 0.5, 2.0).llt().matrixL()),
      activation_(curve(random, n + 3, 1, 1.0)),
      target_(curve(random, n, 1, 0.5)),
      room_(curve(random, n, 2, 0.3)) {
  for (const int rows : {2, 2, 2}) {
    a_.push_back(curve(random, rows, n, 1.0 / std::sqrt(n)));
    b_.push_back(curve(random, rows, 1, 0.5));
  }
  inequality_ = curve(random, inequalities, n, 1.0 / std::sqrt(n));
  inequality_lower_ = curve(random, inequalities, 1, 0.3);
}

Stack StackPath::at(double s) const {
  Stack stack(n_, static_cast<int>(inequality_.centre.rows()));
  stack.motion = motion_;
  const Vector activation = (0.5 + activation_.at(s).array()).min(1.0).max(0.0).matrix();
  stack.limit_activation = activation.head(n_);
  stack.limit_target = target_.at(s);
  const Matrix room = room_.at(s);
  stack.motion_upper = 0.1 + room.col(0).array().square();
  stack.motion_lower = -0.1 - room.col(1).array().square();
  stack.inequality = inequality_.at(s);
  stack.inequality_lower = inequality_lower_.at(s).array() - 0.2;
  if (stack.inequality_lower.size() > 1) {  // they point against each other at s = 0.5
    stack.inequality.row(1) = -stack.inequality.row(0) + 4.0 * (s - 0.5) * stack.inequality.row(1);
    stack.inequality_lower.head(2).array() += 0.3;
  }
  for (std::size_t i = 0; i < a_.size(); ++i) {
    stack.tasks.push_back({.level = static_cast<int>(i) + 1,
                           .activation = activation[n_ + static_cast<int>(i)],
                           .a = a_[i].at(s),
                           .b = b_[i].at(s)});
  }
  if (rank_changing_) {
    TaskRows& first = stack.tasks[0];
    first.a.row(1) = first.a.row(0) + 2.0 * (s - 0.3) * first.a.row(1);  // dependent
    stack.tasks[1].a.row(0) *= 2.0 * (s - 0.5);                          // vanishing
    stack.tasks[2].a.row(1) =
        first.a.row(0) + 2.0 * (s - 0.7) * stack.tasks[2].a.row(1).eval();  // taken above
  }
  return stack;
}

}  // namespace tope::test
