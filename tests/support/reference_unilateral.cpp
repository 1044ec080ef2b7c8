#include "support/reference_unilateral.hpp"

#include "support/random_stack.hpp"

#include <Eigen/SVD>
#include <eiquadprog/eiquadprog-fast.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace tope::test {
namespace {

constexpr double kFar = 1e6;  // eiquadprog takes no infinite bound

/// Weight of |z|^2: damping^2 far from the goal, fine_damping^2 at it.
double weight(const Unilateral::Options& options, const Vector& residual) {
  const double r = residual.norm() / options.fine_below;
  const double far = r * r / (1.0 + r * r);
  return far * std::pow(options.damping, 2) + (1.0 - far) * std::pow(options.fine_damping, 2);
}

Matrix closed(const Matrix& open, const Matrix& a, double lock) {
  const Eigen::JacobiSVD<Matrix> svd(a * open, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::Index n = open.rows();
  Matrix keep = Matrix::Identity(n, n);
  for (Eigen::Index i = 0; i < svd.singularValues().size(); ++i) {
    const double x = std::min(1.0, svd.singularValues()[i] / lock);
    const double locked = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
    const Vector v = svd.matrixV().col(i);
    keep -= locked * v * v.transpose();
  }
  return open * keep;
}

Vector joined(const Vector& first, const Vector& second) {
  Vector both(first.size() + second.size());
  both << first, second;
  return both;
}

/// y over s of level 0, with s itself as unknown: |y|^2 + |s|^2 / softness^2.
Vector limit_level(const Stack& stack, const Vector& lower, const Vector& upper, double softness) {
  const Eigen::Index n = stack.size();
  const Eigen::Index p = stack.inequality.rows();
  Matrix slack_cost = Matrix::Zero(p, n + p);
  slack_cost.rightCols(p).diagonal().setConstant(std::sqrt(1.0 / (softness * softness) - 1.0));
  Matrix rows = Matrix::Zero(n + p, n + p);
  rows.leftCols(n) = bounded_rows(stack);
  rows.bottomRightCorner(p, p).setIdentity();
  return reference_bounded_least_squares(slack_cost, Vector::Zero(p), 1.0, rows, lower, upper);
}

}  // namespace

Vector reference_bounded_least_squares(const Matrix& a, const Vector& r, double mu, const Matrix& d,
                                       const Vector& lower, const Vector& upper) {
  const Eigen::Index n = d.cols();
  const Eigen::Index p = d.rows();
  const Matrix hessian = a.transpose() * a + mu * Matrix::Identity(n, n);
  const Vector gradient = -a.transpose() * r;
  Matrix rows(2 * p, n);
  rows << d, -d;
  Vector offset(2 * p);
  offset << -lower, upper;
  eiquadprog::solvers::EiquadprogFast solver;
  solver.reset(static_cast<std::size_t>(n), 0, static_cast<std::size_t>(2 * p));
  Vector z = Vector::Zero(n);
  const auto status = solver.solve_quadprog(hessian, gradient, Matrix(0, n), Vector(0), rows, offset, z);
  if (status != eiquadprog::solvers::EIQUADPROG_FAST_OPTIMAL) {
    throw std::runtime_error("eiquadprog: status " + std::to_string(status));
  }
  return z;
}

Matrix bounded_rows(const Stack& stack) {
  Matrix rows(stack.motion.rows() + stack.inequality.rows(), stack.size());
  rows << stack.motion, stack.inequality;
  return rows;
}

std::vector<ReferenceLevel> reference_unilateral(const Stack& stack, const Selection& selection,
                                                 const Unilateral::Options& options) {
  const int n = stack.size();
  std::vector<ReferenceLevel> levels;
  const Matrix bounded = bounded_rows(stack);
  Matrix open = Matrix::Identity(n, n);
  Vector y = Vector::Zero(n);
  Vector slack = Vector::Zero(stack.inequality.rows());
  const int last = stack.tasks.empty() ? 0 : stack.tasks.back().level;
  for (int level = 0; level <= last; ++level) {
    const Matrix a = level_matrix(stack, selection, level);
    if (level > 0 && a.rows() == 0) {
      continue;
    }
    const double headroom = options.headroom / (1.0 + level);
    const double other_headroom = options.inequality_headroom / (1.0 + level);
    ReferenceLevel entry{
        .level = level,
        .open = open,
        .lower = joined(stack.motion_lower + headroom * stack.headroom_lower,
                        (stack.inequality_lower - slack).array() + other_headroom),
        .upper = joined(stack.motion_upper - headroom * stack.headroom_upper,
                        Vector::Constant(slack.size(), kFar)),
        .mu = level == 0 ? 1.0 : weight(options, level_target(stack, selection, level) - a * y),
        .a = a,
        .b = level_target(stack, selection, level),
        .singular = Vector(0),
        .y = y,
        .slack = slack};
    if (level == 0) {
      const Vector both = limit_level(stack, entry.lower, entry.upper, options.softness);
      y = both.head(n);
      entry.slack = slack = both.tail(slack.size());
    } else {
      const Vector now = bounded * y;
      y += open * reference_bounded_least_squares(a * open, entry.b - a * y, entry.mu, bounded * open,
                                                  entry.lower - now, entry.upper - now);
    }
    entry.y = y;
    if (level > 0) {
      entry.singular = Eigen::JacobiSVD<Matrix>(a * open).singularValues();
      open = closed(open, a, options.lock);
    }
    levels.push_back(std::move(entry));
  }
  return levels;
}

}  // namespace tope::test
