#include "support/path.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tope::test {
namespace {

struct Step {
  double begin = 0.0;
  double change = -1.0;
};

Step largest_step(const std::function<Vector(double)>& f, double begin, double end, int steps) {
  Step largest;
  Vector last = f(begin);
  for (int i = 1; i <= steps; ++i) {
    const double s = begin + (end - begin) * i / steps;
    const Vector now = f(s);
    const double change = (now - last).lpNorm<Eigen::Infinity>();
    if (change > largest.change) {
      largest = {.begin = begin + (end - begin) * (i - 1) / steps, .change = change};
    }
    last = now;
  }
  return largest;
}

}  // namespace

double largest_jump(const std::function<Vector(double)>& f, int steps) {
  return largest_step(f, 0.0, 1.0, steps).change;
}

double jump_left_after(const std::function<Vector(double)>& f, int steps, int rounds) {
  Step step = largest_step(f, 0.0, 1.0, steps);
  double width = 1.0 / steps;
  for (int round = 0; round < rounds; ++round) {
    step = largest_step(f, step.begin, step.begin + width, 10);
    width /= 10.0;
  }
  return step.change;
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

StackPath::StackPath(Random& random, int n, bool rank_changing)
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
}

Stack StackPath::at(double s) const {
  Stack stack(n_);
  stack.motion = motion_;
  const Vector activation = (0.5 + activation_.at(s).array()).min(1.0).max(0.0).matrix();
  stack.limit_activation = activation.head(n_);
  stack.limit_target = target_.at(s);
  const Matrix room = room_.at(s);
  stack.motion_upper = 0.1 + room.col(0).array().square();
  stack.motion_lower = -0.1 - room.col(1).array().square();
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
