#include <tope/common/error.hpp>
#include <tope/law/hierarchy.hpp>
#include <tope/law/small_cholesky.hpp>
#include <tope/law/small_product.hpp>
#include <tope/law/smooth_step.hpp>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

int workspace_rows(const Stack& stack) { return std::max(stack.size(), stack.max_level_rows()); }

}  // namespace

Hierarchy::Hierarchy(const Stack& stack, const Options& options)
    : options_(options),
      gathered_(stack.size(), workspace_rows(stack)),
      partial_{.first = 0,
               .last = 0,
               .rows = Matrix(workspace_rows(stack), stack.size()),
               .target = Vector(workspace_rows(stack)),
               .ready = false},
      eigen_(workspace_rows(stack)),
      open_(stack.size(), workspace_rows(stack)),
      task_(workspace_rows(stack), stack.size()),
      gram_(workspace_rows(stack), workspace_rows(stack)),
      factor_(workspace_rows(stack), workspace_rows(stack)),
      turned_(workspace_rows(stack), stack.size()),
      residual_(workspace_rows(stack)),
      weights_(workspace_rows(stack)),
      step_(stack.size()),
      share_(workspace_rows(stack)) {
  if (!(0.0 < options.locked_above && options.locked_above < options.damped_below &&
        options.damped_below < 1.0 && options.epsilon > 0.0)) {
    throw ConfigError(
        "hierarchy: must have 0 < locked_above < damped_below < 1 and epsilon > 0, got locked_above " +
        std::to_string(options.locked_above) + ", damped_below " + std::to_string(options.damped_below) +
        ", epsilon " + std::to_string(options.epsilon));
  }
  for (std::size_t first = 0; first < stack.tasks.size();) {
    std::size_t last = first;
    Eigen::Index rows = 0;
    for (; last < stack.tasks.size() && stack.tasks[last].level == stack.tasks[first].level; ++last) {
      rows += stack.tasks[last].a.rows();
    }
    levels_.push_back({.first = first,
                       .last = last,
                       .rows = Matrix(rows, stack.size()),
                       .target = Vector(rows),
                       .ready = false});
    first = last;
  }
}

void Hierarchy::begin() {
  for (Level& level : levels_) {
    level.ready = false;
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
  for (Level& level : levels_) {
    const auto begin = selection.tasks.begin() + static_cast<std::ptrdiff_t>(level.first);
    const auto end = selection.tasks.begin() + static_cast<std::ptrdiff_t>(level.last);
    const auto selected = std::count(begin, end, 1);
    if (selected == 0) {
      continue;
    }
    const bool last = level.last == stack.tasks.size();
    if (selected == end - begin) {
      if (!level.ready) {
        whiten(stack, selection, level.first, level.rows, level.target);
        level.ready = true;
      }
      add_level(level.rows, level.target, last, solution);
    } else {
      whiten(stack, selection, level.first, partial_.rows, partial_.target);
      const int m = gathered_.rows();
      add_level(partial_.rows.topRows(m), partial_.target.head(m), last, solution);
    }
  }
}

void Hierarchy::add_limits(const Stack& stack, const Selection& selection, const Vector& limit_target,
                           Vector& y) {
  open_.reset();
  Eigen::Index m = 0;
  for (Eigen::Index joint = 0; joint < stack.size(); ++joint) {
    if (selection.limits[static_cast<std::size_t>(joint)] != 0) {
      task_.row(m) = stack.motion.row(joint);
      residual_[m] = limit_target[joint];
      ++m;
    }
  }
  if (m == 0) {
    return;
  }
  const auto rows = task_.topRows(m);
  auto targets = residual_.head(m);
  auto gram = gram_.topLeftCorner(m, m);
  multiply(rows, rows.transpose(), gram);
  factorise_in_place(gram);
  solve_lower(gram, targets);
  solve_upper(gram, targets);
  multiply(rows.transpose(), targets, y);
  open_.close(rows);
}

/// Rows and target of the selected tasks of a level in the metric B^-1.
void Hierarchy::whiten(const Stack& stack, const Selection& selection, std::size_t first, Matrix& rows,
                       Vector& target) {
  gathered_.gather(stack, selection, first);
  const int m = gathered_.rows();
  auto gram = gram_.topLeftCorner(m, m);
  multiply(gathered_.a(), gathered_.a().transpose(), gram);
  gram.diagonal().array() += options_.epsilon * options_.epsilon;
  factorise_in_place(gram);
  rows.topRows(m) = gathered_.a();
  target.head(m) = gathered_.b();
  for (Eigen::Index j = 0; j < rows.cols(); ++j) {
    solve_lower(gram, rows.col(j).head(m));
  }
  solve_lower(gram, target.head(m));
}

void Hierarchy::add_level(const Eigen::Ref<const Matrix>& rows, const VectorArg& target, bool last,
                          Solution& solution) {
  const auto m = static_cast<int>(rows.rows());
  // a level that asks for all the freedom there is always loses some to the levels above it
  const bool partial = m < rows.cols();
  if (open_.size() < m) {
    solution.singular = solution.singular || partial;
  }
  if (open_.size() == 0) {
    return;
  }
  auto residual = residual_.head(m);
  residual = target;
  residual -= rows.lazyProduct(solution.y);
  open_.project(rows, task_.topLeftCorner(m, open_.size()));
  if (m <= open_.size()) {
    add_wide_level(m, last, solution);
  } else {
    add_tall_level(m, last, solution);
  }
}

/// No more rows than open directions: by G (m x m).
void Hierarchy::add_wide_level(int m, bool last, Solution& solution) {
  const auto task = task_.topLeftCorner(m, open_.size());
  auto residual = residual_.head(m);
  auto weights = weights_.head(m);
  auto step = step_.head(open_.size());
  auto gram = gram_.topLeftCorner(m, m);
  auto factor = factor_.topLeftCorner(m, m);
  multiply(task, task.transpose(), gram);
  factor = gram;
  factor.diagonal().array() -= options_.damped_below;
  if (factorise_in_place(factor)) {  // every rho > rho_0: the undamped law
    factor = gram;
    factorise_in_place(factor);
    solve_lower(factor, residual);
    solve_upper(factor, residual);
    multiply(task.transpose(), residual, step);
    solution.y += open_.columns().lazyProduct(step);
    if (!last) {
      open_.close(task);
    }
    return;
  }
  const SymmetricEigen::Solver& eigen = eigen_.compute(gram);
  solution.singular = solution.singular || m < open_.columns().rows();
  auto turned = turned_.topLeftCorner(m, open_.size());
  multiply(eigen.eigenvectors().transpose(), task, turned);
  multiply(eigen.eigenvectors().transpose(), residual, weights);
  auto share = share_.head(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const double rho = std::max(0.0, eigen.eigenvalues()[i]);
    weights[i] /= damped(rho);
    // (1 - sqrt(1 - s)) / rho, which tends to 0 with rho
    const double closed = smooth_step(rho / options_.locked_above);
    share[i] = rho > 1e-12 ? (1.0 - std::sqrt(1.0 - closed)) / rho : 0.0;
  }
  multiply(turned.transpose(), weights, step);
  solution.y += open_.columns().lazyProduct(step);
  if (!last) {
    open_.fade(turned, share);
  }
}

/// More rows than open directions: by the twin of G with the same spectrum, less its zeros (d x d).
void Hierarchy::add_tall_level(int m, bool last, Solution& solution) {
  const int d = open_.size();
  const auto task = task_.topLeftCorner(m, d);
  auto gram = gram_.topLeftCorner(d, d);
  auto factor = factor_.topLeftCorner(d, d);
  auto step = step_.head(d);
  multiply(task.transpose(), task, gram);
  multiply(task.transpose(), residual_.head(m), step);
  factor = gram;
  factor.diagonal().array() -= options_.damped_below;
  if (factorise_in_place(factor)) {
    factor = gram;
    factorise_in_place(factor);
    solve_lower(factor, step);
    solve_upper(factor, step);
    solution.y += open_.columns().lazyProduct(step);
    if (!last) {
      open_.close_all();
    }
    return;
  }
  const SymmetricEigen::Solver& eigen = eigen_.compute(gram);
  auto weights = weights_.head(d);
  auto turned = turned_.topLeftCorner(d, d);
  auto share = share_.head(d);
  turned = eigen.eigenvectors().transpose();
  multiply(turned, step, weights);
  for (Eigen::Index i = 0; i < d; ++i) {
    const double rho = std::max(0.0, eigen.eigenvalues()[i]);
    weights[i] /= damped(rho);
    share[i] = 1.0 - std::sqrt(1.0 - smooth_step(rho / options_.locked_above));
  }
  multiply(turned.transpose(), weights, step);
  solution.y += open_.columns().lazyProduct(step);
  if (!last) {
    open_.fade(turned, share);
  }
}

/// 1 / g(rho).
double Hierarchy::damped(double rho) const {
  const double deficit = std::max(0.0, 1.0 - rho / options_.damped_below);
  return rho + options_.damped_below * deficit * deficit;
}

}  // namespace tope
