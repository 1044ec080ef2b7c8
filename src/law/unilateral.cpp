#include "../common/require_positive.hpp"

#include <tope/common/error.hpp>
#include <tope/law/unilateral.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

using InPlaceCholesky = Eigen::LLT<Eigen::Ref<Matrix>>;

int workspace_rows(const Stack& stack) { return std::max(1, stack.max_level_rows()); }

}  // namespace

Unilateral::Unilateral(const Stack& stack, const Options& options)
    : options_(options),
      rows_(stack.size(), workspace_rows(stack)),
      solver_(stack.size(), stack.size()),
      eigen_(workspace_rows(stack)),
      open_(stack.size(), stack.size()),
      task_(workspace_rows(stack), stack.size()),
      task_gram_(workspace_rows(stack), workspace_rows(stack)),
      factor_(workspace_rows(stack), workspace_rows(stack)),
      turned_task_(workspace_rows(stack), stack.size()),
      open_task_(stack.size(), workspace_rows(stack)),
      motion_(stack.size(), stack.size()),
      residual_(workspace_rows(stack)),
      motion_at_y_(stack.size()),
      lower_(stack.size()),
      upper_(stack.size()),
      no_rows_(0, stack.size()),
      no_residual_(0) {
  require_positive("unilateral: damping", options.damping);
  require_positive("unilateral: fine_damping", options.fine_damping);
  require_positive("unilateral: fine_below", options.fine_below);
  require_positive("unilateral: lock", options.lock);
  require_positive("unilateral: headroom", options.headroom);
  if (options.fine_damping > options.damping) {
    throw ConfigError("unilateral: fine_damping " + std::to_string(options.fine_damping) +
                      " must not exceed damping " + std::to_string(options.damping));
  }
}

void Unilateral::solve(const Stack& stack, const Selection& selection, Solution& solution) {
  solution.set_zero();
  solution.laws = 1;
  open_.setIdentity();
  set_bounds(stack, 0, solution.y);
  solution.cut_off = !solver_.solve(no_rows_, no_residual_, 1.0, stack.motion, lower_, upper_);
  solution.y = solver_.z();
  solution.y_limits = solution.y;

  for (std::size_t i = 0; i < stack.tasks.size();) {
    const int level = stack.tasks[i].level;
    i = rows_.gather(stack, selection, i);
    const int m = rows_.rows();
    if (m == 0) {
      continue;
    }
    task_.topRows(m).noalias() = rows_.a() * open_;
    residual_.head(m) = rows_.b();
    residual_.head(m).noalias() -= rows_.a() * solution.y;
    motion_.noalias() = stack.motion * open_;
    set_bounds(stack, level, solution.y);
    const bool solved =
        solver_.solve(task_.topRows(m), residual_.head(m), squared_damping(residual_.head(m).squaredNorm()),
                      motion_, lower_, upper_);
    solution.cut_off = solution.cut_off || !solved;
    solution.y.noalias() += open_ * solver_.z();
    const bool last = i == stack.tasks.size();
    if (m < stack.size() || !last) {
      const bool clear = all_directions_clear();
      // a level that asks for all the freedom there is always loses some to the levels above it
      solution.singular = solution.singular || (!clear && m < stack.size());
      if (!last && clear) {
        lock_fully();
      } else if (!last) {
        lock_gradually();
      }
    }
  }
}

double Unilateral::squared_damping(double squared_residual) const {
  const double fine = options_.fine_damping * options_.fine_damping;
  const double full = options_.damping * options_.damping;
  return fine +
         (full - fine) * squared_residual / (squared_residual + options_.fine_below * options_.fine_below);
}

/// Bounds on T M z: the stack's, tightened by the level's headroom, less what y already uses.
void Unilateral::set_bounds(const Stack& stack, int level, const Vector& y) {
  const double headroom = options_.headroom / (1.0 + level);
  motion_at_y_.noalias() = stack.motion * y;
  lower_ = (stack.motion_lower - motion_at_y_).array() + headroom;
  upper_ = (stack.motion_upper - motion_at_y_).array() - headroom;
}

/// Computes A M M^T A^T; true when every sigma exceeds the lock.
bool Unilateral::all_directions_clear() {
  const int m = rows_.rows();
  auto gram = task_gram_.topLeftCorner(m, m);
  auto factor = factor_.topLeftCorner(m, m);
  gram.noalias() = task_.topRows(m) * task_.topRows(m).transpose();
  factor = gram;
  factor.diagonal().array() -= options_.lock * options_.lock;
  return InPlaceCholesky(factor).info() == Eigen::Success;
}

/// Takes all directions of the level out of M: an exact projector.
void Unilateral::lock_fully() {
  const int m = rows_.rows();
  auto task = task_.topRows(m);
  auto open_task = open_task_.leftCols(m);
  auto factor = factor_.topLeftCorner(m, m);
  factor = task_gram_.topLeftCorner(m, m);
  const InPlaceCholesky cholesky(factor);
  cholesky.matrixL().solveInPlace(task);
  open_task.noalias() = open_ * task.transpose();
  open_.noalias() -= open_task * task;
}

/// Takes each direction out of M as far as its sigma says.
void Unilateral::lock_gradually() {
  const int m = rows_.rows();
  auto task = task_.topRows(m);
  auto open_task = open_task_.leftCols(m);
  const SymmetricEigen::Solver& eigen = eigen_.compute(task_gram_.topLeftCorner(m, m));
  turned_task_.topRows(m).noalias() = eigen.eigenvectors().transpose() * task;
  task = turned_task_.topRows(m);  // rows sigma v^T
  open_task.noalias() = open_ * task.transpose();
  for (Eigen::Index i = 0; i < m; ++i) {
    // s(x) / sigma^2 with x = sigma / lock, written so that it stays finite at sigma = 0
    const double x = std::sqrt(std::max(0.0, eigen.eigenvalues()[i])) / options_.lock;
    const double quotient = x < 1.0 ? x * (10.0 + x * (6.0 * x - 15.0)) : 1.0 / (x * x);
    open_task.col(i) *= quotient / (options_.lock * options_.lock);
  }
  open_.noalias() -= open_task * task;
}

}  // namespace tope
