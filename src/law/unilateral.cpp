#include "../common/require_positive.hpp"

#include <tope/common/error.hpp>
#include <tope/law/small_cholesky.hpp>
#include <tope/law/small_product.hpp>
#include <tope/law/unilateral.hpp>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

int workspace_rows(const Stack& stack) { return std::max(1, stack.max_level_rows()); }

}  // namespace

Unilateral::Unilateral(const Stack& stack, const Options& options)
    : options_(options),
      rows_(stack.size(), workspace_rows(stack)),
      solver_(stack.size(), stack.size()),
      eigen_(workspace_rows(stack)),
      open_(stack.size(), stack.size()),
      next_open_(stack.size(), stack.size()),
      motion_(stack.size(), stack.size()),
      next_motion_(stack.size(), stack.size()),
      task_(workspace_rows(stack), stack.size()),
      task_gram_(workspace_rows(stack), workspace_rows(stack)),
      factor_(workspace_rows(stack), workspace_rows(stack)),
      turned_task_(std::max(workspace_rows(stack), stack.size()),
                   std::max(workspace_rows(stack), stack.size())),
      open_task_(stack.size(), workspace_rows(stack)),
      turn_(stack.size(), stack.size()),
      reflector_scale_(stack.size()),
      residual_(workspace_rows(stack)),
      motion_at_y_(stack.size()),
      lower_(stack.size()),
      upper_(stack.size()),
      active_(stack.tasks.size() + 1,
              BoundedLeastSquares::ActiveRows(static_cast<std::size_t>(stack.size()), 0)),
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
  solve_limits(stack, solution);
  open_count_ = stack.size();
  whole_ = true;
  open_.setIdentity();
  motion_ = stack.motion;
  std::size_t position = 1;
  for (std::size_t i = 0; i < stack.tasks.size(); ++position) {
    const int level = stack.tasks[i].level;
    i = rows_.gather(stack, selection, i);
    if (rows_.rows() == 0) {
      continue;
    }
    set_bounds(stack, level);
    solve_level(position, solution);
    const bool last = i == stack.tasks.size();
    const bool partial = rows_.rows() < stack.size();
    if (last && !partial) {
      continue;
    }
    const bool clear = all_directions_clear();
    // a level that asks for all the freedom there is always loses some to the levels above it
    solution.singular = solution.singular || (!clear && partial);
    if (!last && clear) {
      lock_fully();
    } else if (!last) {
      lock_gradually(stack);
    }
  }
}

/// Level 0: the least-norm point inside the bounds, which is zero unless a joint is to be led back.
void Unilateral::solve_limits(const Stack& stack, Solution& solution) {
  motion_at_y_.setZero();
  set_bounds(stack, 0);
  if (lower_.maxCoeff() <= 0.0 && upper_.minCoeff() >= 0.0) {
    return;
  }
  solution.cut_off =
      !solver_.solve(no_rows_, no_residual_, 1.0, stack.motion, lower_, upper_, active_.front());
  solution.y = solver_.z();
  solution.y_limits = solution.y;
  motion_at_y_ = solver_.row_values();
}

/// What the gathered rows want beyond y, in the directions that are open.
void Unilateral::solve_level(std::size_t position, Solution& solution) {
  const int m = rows_.rows();
  auto task = task_.topLeftCorner(m, open_count_);
  auto residual = residual_.head(m);
  if (whole_) {
    task = rows_.a();
  } else {
    multiply(rows_.a(), open(), task);
  }
  residual = rows_.b();
  residual -= rows_.a().lazyProduct(solution.y);
  const bool solved = solver_.solve(task, residual, squared_damping(residual.squaredNorm()),
                                    motion_.leftCols(open_count_), lower_, upper_, active_[position]);
  solution.cut_off = solution.cut_off || !solved;
  solution.y += open().lazyProduct(solver_.z());
  motion_at_y_ += solver_.row_values();
}

double Unilateral::squared_damping(double squared_residual) const {
  const double fine = options_.fine_damping * options_.fine_damping;
  const double full = options_.damping * options_.damping;
  return fine +
         (full - fine) * squared_residual / (squared_residual + options_.fine_below * options_.fine_below);
}

/// Bounds on T M z: the stack's, tightened by the level's headroom, less what y already uses.
void Unilateral::set_bounds(const Stack& stack, int level) {
  const double headroom = options_.headroom / (1.0 + level);
  lower_ = (stack.motion_lower - motion_at_y_).array() + headroom;
  upper_ = (stack.motion_upper - motion_at_y_).array() - headroom;
}

/// Computes A M M^T A^T; true when every sigma exceeds the lock.
bool Unilateral::all_directions_clear() {
  const int m = rows_.rows();
  const auto task = task_.topLeftCorner(m, open_count_);
  auto gram = task_gram_.topLeftCorner(m, m);
  auto factor = factor_.topLeftCorner(m, m);
  multiply(task, task.transpose(), gram);
  factor = gram;
  factor.diagonal().array() -= options_.lock * options_.lock;
  return m <= open_count_ && factorise_in_place(factor);
}

/// Takes all directions of the level out of M: an orthonormal basis of what is left, by Householder reflections.
void Unilateral::lock_fully() {
  const int m = rows_.rows();
  auto columns = turned_task_.topLeftCorner(open_count_, m);
  columns = task_.topLeftCorner(m, open_count_).transpose();
  for (int k = 0; k < m; ++k) {
    auto pivot = columns.col(k).tail(open_count_ - k);
    const double length = pivot.norm();
    pivot[0] += std::copysign(length, pivot[0]);
    reflector_scale_[k] = 2.0 / pivot.squaredNorm();
    for (int j = k + 1; j < m; ++j) {
      auto column = columns.col(j).tail(open_count_ - k);
      column -= (reflector_scale_[k] * pivot.dot(column)) * pivot;
    }
  }
  turn_open_basis(m);
}

/// M <- M Q_2, T M <- T M Q_2 with the columns Q_2 of the reflections' product that the level's rows do not reach.
void Unilateral::turn_open_basis(int rank) {
  const int left = open_count_ - rank;
  auto turn = turn_.topLeftCorner(open_count_, left);
  turn.setZero();
  turn.bottomRows(left).setIdentity();
  for (int k = rank - 1; k >= 0; --k) {
    const auto reflector = turned_task_.col(k).segment(k, open_count_ - k);
    for (int j = 0; j < left; ++j) {
      auto column = turn.col(j).tail(open_count_ - k);
      column -= (reflector_scale_[k] * reflector.dot(column)) * reflector;
    }
  }
  auto next_motion = next_motion_.leftCols(left);
  if (whole_) {
    next_open_.leftCols(left) = turn;
  } else {
    multiply(open(), turn, next_open_.leftCols(left));
  }
  multiply(motion_.leftCols(open_count_), turn, next_motion);
  open_.swap(next_open_);
  motion_.swap(next_motion_);
  open_count_ = left;
  whole_ = false;
}

/// Takes each direction out of M as far as its sigma says.
void Unilateral::lock_gradually(const Stack& stack) {
  const int m = rows_.rows();
  auto task = task_.topLeftCorner(m, open_count_);
  auto turned = turned_task_.topLeftCorner(m, open_count_);
  auto open_task = open_task_.leftCols(m);
  const SymmetricEigen::Solver& eigen = eigen_.compute(task_gram_.topLeftCorner(m, m));
  multiply(eigen.eigenvectors().transpose(), task, turned);  // rows sigma v^T
  multiply(open(), turned.transpose(), open_task);
  for (Eigen::Index i = 0; i < m; ++i) {
    // s(x) / sigma^2 with x = sigma / lock, written so that it stays finite at sigma = 0
    const double x = std::sqrt(std::max(0.0, eigen.eigenvalues()[i])) / options_.lock;
    const double quotient = x < 1.0 ? x * (10.0 + x * (6.0 * x - 15.0)) : 1.0 / (x * x);
    open_task.col(i) *= quotient / (options_.lock * options_.lock);
  }
  open_.leftCols(open_count_) -= open_task.lazyProduct(turned);
  multiply(stack.motion, open(), motion_.leftCols(open_count_));
  whole_ = false;
}

}  // namespace tope
