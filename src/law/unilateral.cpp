#include "../common/require_positive.hpp"

#include <tope/common/error.hpp>
#include <tope/law/smooth_step.hpp>
#include <tope/law/unilateral.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tope {
namespace {

int workspace_rows(const Stack& stack) { return std::max(1, stack.max_level_rows()); }

int bounded_rows(const Stack& stack) {
  return stack.size() + static_cast<int>(stack.inequality_lower.size());
}

}  // namespace

Unilateral::Unilateral(const Stack& stack, const Options& options)
    : options_(options),
      size_(stack.size()),
      inequalities_(static_cast<int>(stack.inequality_lower.size())),
      rows_(stack.size(), workspace_rows(stack)),
      limit_solver_(bounded_rows(stack), bounded_rows(stack)),
      solver_(stack.size(), bounded_rows(stack)),
      clear_(stack.size()),
      eigen_(stack.size()),
      spectrum_(stack.size(), stack.size()),
      open_(stack.size(), bounded_rows(stack)),
      task_(workspace_rows(stack), stack.size()),
      shares_(stack.size()),
      residual_(Vector::Zero(PanelMatrix::padded(workspace_rows(stack)))),
      y_(Vector::Zero(PanelMatrix::padded(stack.size()))),
      bounded_(Matrix::Zero(bounded_rows(stack), stack.size())),
      softened_(bounded_rows(stack), bounded_rows(stack)),
      motion_(Vector::Zero(PanelMatrix::padded(bounded_rows(stack)))),
      slack_(Vector::Zero(inequalities_)),
      lower_(bounded_rows(stack)),
      upper_(Vector::Constant(bounded_rows(stack), std::numeric_limits<double>::infinity())),
      active_(stack.tasks.size() + 1,
              BoundedLeastSquares::ActiveRows(static_cast<std::size_t>(bounded_rows(stack)), 0)),
      no_rows_(0, bounded_rows(stack)) {
  require_positive("unilateral: damping", options.damping);
  require_positive("unilateral: fine_damping", options.fine_damping);
  require_positive("unilateral: fine_below", options.fine_below);
  require_positive("unilateral: lock", options.lock);
  require_positive("unilateral: headroom", options.headroom);
  require_positive("unilateral: inequality_headroom", options.inequality_headroom);
  require_positive("unilateral: softness", options.softness);
  if (options.fine_damping > options.damping) {
    throw ConfigError("unilateral: fine_damping " + std::to_string(options.fine_damping) +
                      " must not exceed damping " + std::to_string(options.damping));
  }
  for (int i = size_; i < bounded_rows(stack); ++i) {
    softened_(i, i) = options.softness;
  }
}

void Unilateral::solve(const Stack& stack, const Selection& selection, Solution& solution) {
  solution.begin();
  solution.y_limits.setZero();
  open_all(stack);
  motion_.setZero();
  slack_.setZero();
  set_bounds(stack, 0);
  solve_limits(solution);
  std::size_t position = 1;
  for (std::size_t i = 0; i < stack.tasks.size(); ++position) {
    const int level = stack.tasks[i].level;
    i = rows_.gather(stack, selection, i);
    if (rows_.rows() == 0) {
      continue;
    }
    set_bounds(stack, level);
    const PanelMatrix& task = open_task();
    const bool solved = solve_level(task, position);
    solution.cut_off = solution.cut_off || !solved;
    const bool last = i == stack.tasks.size();
    const bool partial = rows_.rows() < stack.size();
    if (last && !partial) {
      continue;
    }
    const bool clear = all_directions_clear(task);
    // a level that asks for all the freedom there is always loses some to the levels above it
    solution.singular = solution.singular || (!clear && partial);
    if (!last && clear) {
      open_.close(task);
    } else if (!last) {
      lock_gradually(task);
    }
  }
  solution.y = y_.head(stack.size());
}

void Unilateral::open_all(const Stack& stack) {
  if (inequalities_ > 0) {
    bounded_.topRows(size_) = stack.motion;
    bounded_.bottomRows(inequalities_) = stack.inequality;
    open_.reset(bounded_);
  } else if (stack.motion_is_y) {
    open_.reset();
  } else {
    open_.reset(stack.motion);
  }
}

/// Level 0: zero unless a joint is to be led back or an inequality row asks for motion.
void Unilateral::solve_limits(Solution& solution) {
  y_.setZero();
  if (lower_.maxCoeff() <= 0.0 && upper_.minCoeff() >= 0.0) {
    return;
  }
  solution.cut_off =
      !limit_solver_.solve(no_rows_, residual_, 1.0, softened_rows(), lower_, upper_, active_.front());
  solution.y_limits = limit_solver_.z().head(size_);
  y_.head(size_) = solution.y_limits;
  motion_.head(size_) = limit_solver_.row_values().head(size_);
  motion_.segment(size_, inequalities_) = limit_solver_.row_values().tail(inequalities_) -
                                          options_.softness * limit_solver_.z().tail(inequalities_);
  // not s of the solver: what y falls short by even where that was cut off
  slack_ = (lower_.tail(inequalities_) - motion_.segment(size_, inequalities_)).cwiseMax(0.0);
}

/// The bounded rows of level 0, for y and s / softness.
const PanelMatrix& Unilateral::softened_rows() {
  if (inequalities_ == 0) {
    return open_.image();
  }
  softened_.set_rows(0, bounded_);
  return softened_;
}

/// A M for the gathered rows.
const PanelMatrix& Unilateral::open_task() {
  return rows_.is_motion() ? open_.image() : open_.project(rows_.a(), task_);
}

/// What the gathered rows want beyond y, in the directions that are open. False when cut off.
bool Unilateral::solve_level(const PanelMatrix& task, std::size_t position) {
  const Eigen::Index padded = PanelMatrix::padded(rows_.rows());
  if (rows_.is_motion()) {
    residual_.head(padded) = rows_.b().head(padded) - motion_;
  } else {
    subtract_product(rows_.b().data(), rows_.a(), y_.data(), residual_.data());
  }
  const bool solved = solver_.solve(task, residual_, squared_damping(residual_.head(padded).squaredNorm()),
                                    open_.image(), lower_, upper_, active_[position]);
  motion_.head(lower_.size()) += solver_.row_values();
  if (open_.has_image()) {
    add_product(open_.columns(), solver_.z().data(), y_.data());
  } else {
    y_ = motion_;
  }
  return solved;
}

double Unilateral::squared_damping(double squared_residual) const {
  const double fine = options_.fine_damping * options_.fine_damping;
  const double full = options_.damping * options_.damping;
  return fine +
         (full - fine) * squared_residual / (squared_residual + options_.fine_below * options_.fine_below);
}

/// Bounds on [T; C] M z: the stack's, tightened by the level's headroom, less what y already uses.
void Unilateral::set_bounds(const Stack& stack, int level) {
  const double headroom = options_.headroom / (1.0 + level);
  const auto motion = motion_.head(size_);
  lower_.head(size_) = stack.motion_lower - motion + headroom * stack.headroom_lower;
  upper_.head(size_) = stack.motion_upper - motion - headroom * stack.headroom_upper;
  const auto others = motion_.segment(size_, inequalities_);
  lower_.tail(inequalities_) =
      (stack.inequality_lower - slack_ - others).array() + options_.inequality_headroom / (1.0 + level);
}

/// True when every sigma exceeds the lock.
bool Unilateral::all_directions_clear(const PanelMatrix& task) {
  return task.rows() <= task.cols() &&
         clear_.positive_definite(solver_.gram(), -options_.lock * options_.lock);
}

/// Takes each direction out of M as far as its sigma says.
void Unilateral::lock_gradually(const PanelMatrix& task) {
  spectrum_.compute(task, solver_.gram(), eigen_);
  for (int i = 0; i < spectrum_.size(); ++i) {
    shares_[i] = quintic_step(std::sqrt(spectrum_.squared()[i]) / options_.lock);
  }
  open_.close(spectrum_, shares_);
}

}  // namespace tope
