#include "../common/require_positive.hpp"

#include <tope/common/error.hpp>
#include <tope/law/smooth_unilateral.hpp>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <string>

namespace tope {
namespace {

constexpr int kMostSolutions = 16;

/// The symmetric matrix whose eigenvalues are the n Gauss-Legendre nodes on [-1, 1] (Golub and Welsch 1969).
Matrix jacobi_matrix(int n) {
  Matrix jacobi = Matrix::Zero(n, n);
  for (int k = 1; k < n; ++k) {
    jacobi(k, k - 1) = k / std::sqrt(4.0 * k * k - 1.0);
  }
  return jacobi;
}

}  // namespace

void Smoothing::check() const {
  if (solutions < 2 || solutions > kMostSolutions) {
    throw ConfigError("unilateral: smoothing.solutions must be from 2 to " + std::to_string(kMostSolutions) +
                      ", got " + std::to_string(solutions));
  }
  require_positive("unilateral: smoothing.spread", spread);
}

SmoothUnilateral::SmoothUnilateral(const Stack& stack, const Unilateral::Options& options,
                                   const Smoothing& smoothing)
    : part_(stack.size()) {
  smoothing.check();
  const Eigen::SelfAdjointEigenSolver<Matrix> rule(jacobi_matrix(smoothing.solutions));
  for (int i = 0; i < smoothing.solutions; ++i) {
    const double x = 0.5 * (1.0 + rule.eigenvalues()[i]);
    Unilateral::Options own = options;
    own.headroom *= smoothing.factor(x);
    own.inequality_headroom *= smoothing.factor(x);
    const double root = rule.eigenvectors()(0, i);
    nodes_.push_back({root * root, Unilateral(stack, own)});
  }
}

void SmoothUnilateral::solve(const Stack& stack, const Selection& selection, Solution& solution) {
  solution.set_zero();
  for (Node& node : nodes_) {
    node.law.solve(stack, selection, part_);
    solution.add(node.weight, part_);
  }
}

}  // namespace tope
