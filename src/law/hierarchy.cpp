#include <tope/common/error.hpp>
#include <tope/law/hierarchy.hpp>
#include <tope/law/smooth_step.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

using InPlaceCholesky = Eigen::LLT<Eigen::Ref<Matrix>>;

int workspace_rows(const Stack& stack) { return std::max(stack.size(), stack.max_level_rows()); }

}  // namespace

Hierarchy::Hierarchy(const Stack& stack, const Options& options)
    : options_(options),
      rows_(stack.size(), workspace_rows(stack)),
      eigen_(workspace_rows(stack)),
      null_space_(stack.size(), stack.size()),
      whitened_(workspace_rows(stack), stack.size()),
      projected_(workspace_rows(stack), stack.size()),
      gram_(workspace_rows(stack), workspace_rows(stack)),
      factor_(workspace_rows(stack), workspace_rows(stack)),
      residual_(workspace_rows(stack)),
      weights_(workspace_rows(stack)) {
  if (!(0.0 < options.locked_above && options.locked_above < options.damped_below &&
        options.damped_below < 1.0 && options.epsilon > 0.0)) {
    throw ConfigError(
        "hierarchy: must have 0 < locked_above < damped_below < 1 and epsilon > 0, got locked_above " +
        std::to_string(options.locked_above) + ", damped_below " + std::to_string(options.damped_below) +
        ", epsilon " + std::to_string(options.epsilon));
  }
}

void Hierarchy::solve(const Stack& stack, const Selection& selection, Solution& solution) {
  solve(stack, selection, stack.limit_target, solution);
}

void Hierarchy::solve(const Stack& stack, const Selection& selection, const Vector& limit_target,
                      Solution& solution) {
  solution.set_zero();
  solution.laws = 1;
  add_limits(stack, selection, limit_target, solution.y);
  solution.y_limits = solution.y;
  for (std::size_t i = 0; i < stack.tasks.size();) {
    i = rows_.gather(stack, selection, i);
    if (rows_.rows() > 0) {
      add_level(i == stack.tasks.size(), solution);
    }
  }
}

void Hierarchy::add_limits(const Stack& stack, const Selection& selection, const Vector& limit_target,
                           Vector& y) {
  null_space_.setIdentity();
  Eigen::Index m = 0;
  for (Eigen::Index joint = 0; joint < stack.size(); ++joint) {
    if (selection.limits[static_cast<std::size_t>(joint)] != 0) {
      whitened_.row(m) = stack.motion.row(joint);
      residual_[m] = limit_target[joint];
      ++m;
    }
  }
  if (m == 0) {
    return;
  }
  auto rows = whitened_.topRows(m);
  auto targets = residual_.head(m);
  auto gram = gram_.topLeftCorner(m, m);
  gram.noalias() = rows * rows.transpose();
  const InPlaceCholesky cholesky(gram);
  cholesky.matrixL().solveInPlace(rows);
  cholesky.matrixL().solveInPlace(targets);
  y.noalias() = rows.transpose() * targets;
  null_space_.noalias() -= rows.transpose() * rows;
}

void Hierarchy::add_level(bool last, Solution& solution) {
  const int m = rows_.rows();
  auto whitened = whitened_.topRows(m);
  auto projected = projected_.topRows(m);
  auto residual = residual_.head(m);
  auto gram = gram_.topLeftCorner(m, m);
  auto factor = factor_.topLeftCorner(m, m);

  gram.noalias() = rows_.a() * rows_.a().transpose();
  gram.diagonal().array() += options_.epsilon * options_.epsilon;
  whitened = rows_.a();
  residual = rows_.b();
  residual.noalias() -= rows_.a() * solution.y;
  {
    const InPlaceCholesky metric(gram);
    metric.matrixL().solveInPlace(whitened);
    metric.matrixL().solveInPlace(residual);
  }
  projected.noalias() = whitened * null_space_;
  gram.noalias() = projected * whitened.transpose();

  factor = gram;
  factor.diagonal().array() -= options_.damped_below;
  if (InPlaceCholesky(factor).info() != Eigen::Success) {
    add_damped_level(last, solution);
    return;
  }
  factor = gram;  // every rho > rho_0: the undamped law
  const InPlaceCholesky cholesky(factor);
  cholesky.matrixL().solveInPlace(projected);
  cholesky.matrixL().solveInPlace(residual);
  solution.y.noalias() += projected.transpose() * residual;
  if (!last) {
    null_space_.noalias() -= projected.transpose() * projected;
  }
}

void Hierarchy::add_damped_level(bool last, Solution& solution) {
  const int m = rows_.rows();
  auto projected = projected_.topRows(m);
  auto weights = weights_.head(m);
  const SymmetricEigen::Solver& eigen = eigen_.compute(gram_.topLeftCorner(m, m));
  // a level that asks for all the freedom there is always loses some to the levels above it
  solution.singular = solution.singular || m < null_space_.rows();

  weights.noalias() = eigen.eigenvectors().transpose() * residual_.head(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const double rho = std::max(0.0, eigen.eigenvalues()[i]);
    const double deficit = std::max(0.0, 1.0 - rho / options_.damped_below);
    weights[i] /= rho + options_.damped_below * deficit * deficit;
  }
  residual_.head(m).noalias() = eigen.eigenvectors() * weights;
  solution.y.noalias() += projected.transpose() * residual_.head(m);
  if (last) {
    return;
  }
  auto lost = whitened_.topRows(m);
  lost.noalias() = eigen.eigenvectors().transpose() * projected;
  for (Eigen::Index i = 0; i < m; ++i) {
    const double rho = eigen.eigenvalues()[i];
    // s(rho)/rho tends to 0 with rho
    lost.row(i) *= rho > 1e-12 ? std::sqrt(smooth_step(rho / options_.locked_above) / rho) : 0.0;
  }
  null_space_.noalias() -= lost.transpose() * lost;
}

}  // namespace tope
