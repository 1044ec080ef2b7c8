#include <tope/common/error.hpp>
#include <tope/law/hierarchy.hpp>
#include <tope/law/smooth_step.hpp>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

int workspace_rows(const Stack& stack) { return std::max(stack.size(), stack.max_level_rows()); }

}  // namespace

Hierarchy::Level::Level(const Stack& stack, int max_rows)
    : given(stack.size(), max_rows), metric(max_rows, max_rows), factor(max_rows) {}

Hierarchy::Hierarchy(const Stack& stack, const Options& options)
    : options_(options),
      partial_(stack, workspace_rows(stack)),
      spectrum_(stack.size()),
      held_(static_cast<std::size_t>(stack.size()), 0),
      held_target_(stack.size()),
      held_rows_(stack.size(), 1),
      held_open_(stack.size()),
      held_y_(Vector::Zero(PanelMatrix::padded(stack.size()))),
      closed_(stack.size(), workspace_rows(stack)),
      open_(stack.size()),
      motion_(stack.size(), stack.size()),
      limit_row_(1, stack.size()),
      task_(workspace_rows(stack), stack.size()),
      gram_(workspace_rows(stack), workspace_rows(stack)),
      excess_(workspace_rows(stack), workspace_rows(stack)),
      factor_(workspace_rows(stack)),
      clear_(workspace_rows(stack)),
      y_(held_y_),
      residual_(Vector::Zero(PanelMatrix::padded(workspace_rows(stack)))),
      weights_(residual_),
      step_(residual_),
      shares_(stack.size()) {
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
      rows += stack.tasks[last].b.size();
    }
    Level& level = levels_.emplace_back(stack, static_cast<int>(rows));
    level.first = first;
    level.last = last;
    first = last;
    needs_basis_ = needs_basis_ || (rows >= stack.size() && !stack.motion_is_y);
  }
}

void Hierarchy::begin() {
  for (Level& level : levels_) {
    level.ready = false;
  }
  release_limits();
}

void Hierarchy::solve(const Stack& stack, const Selection& selection, Solution& solution) {
  solve(stack, selection, stack.limit_target, solution);
}

void Hierarchy::solve(const Stack& stack, const Selection& selection, const Vector& limit_target,
                      Solution& solution) {
  solution.set_zero();
  solution.laws = 1;
  hold_limits(stack, selection, limit_target);
  by_basis_ = needs_basis_;
  by_basis_ ? open_.reset(held_open_) : closed_.reset(held_rows_);
  y_ = held_y_;
  solution.y_limits = held_y_.head(stack.size());
  for (Level& level : levels_) {
    const auto begin = selection.tasks.begin() + static_cast<std::ptrdiff_t>(level.first);
    const auto end = selection.tasks.begin() + static_cast<std::ptrdiff_t>(level.last);
    const auto selected = std::count(begin, end, 1);
    if (selected == 0) {
      continue;
    }
    const bool last = level.last == stack.tasks.size();
    const bool complete = selected == end - begin;
    Level& chosen = complete ? level : partial_;
    if (!complete || !level.ready) {
      chosen.first = level.first;
      prepare(stack, selection, chosen);
    }
    add_level(stack, chosen, last, solution);
  }
  solution.y = y_.head(stack.size());
}

/// Level 0. The selections of a chain grow: what is held already stays.
void Hierarchy::hold_limits(const Stack& stack, const Selection& selection, const Vector& limit_target) {
  for (std::size_t j = 0; j < held_.size(); ++j) {
    const auto joint = static_cast<Eigen::Index>(j);
    if (held_[j] != 0 && (selection.limits[j] == 0 || held_target_[joint] != limit_target[joint])) {
      release_limits();
      break;
    }
  }
  for (std::size_t j = 0; j < held_.size(); ++j) {
    if (selection.limits[j] != 0 && held_[j] == 0) {
      const auto joint = static_cast<Eigen::Index>(j);
      hold_limit(stack, joint, limit_target[joint]);
    }
  }
}

void Hierarchy::release_limits() {
  std::fill(held_.begin(), held_.end(), 0);
  held_rows_.reset();
  held_open_.reset();
  held_y_.setZero();
}

/// One more limit row, in the directions that those before it leave: no damping, the rows are independent.
void Hierarchy::hold_limit(const Stack& stack, Eigen::Index joint, double target) {
  held_[static_cast<std::size_t>(joint)] = 1;
  held_target_[joint] = target;
  limit_row_.set_rows(0, stack.motion.row(joint));
  held_rows_.project(limit_row_, task_);
  multiply_rows(task_, gram_);
  const double norm = std::sqrt(gram_(0, 0));
  scale(task_, 1.0 / norm);
  const double missing = target - stack.motion.row(joint).dot(held_y_.head(stack.size()));
  for (Eigen::Index i = 0; i < stack.size(); ++i) {
    held_y_[i] += missing / norm * task_(0, i);
  }
  held_rows_.close(task_);
  if (needs_basis_) {
    held_open_.close(held_open_.project(task_, gram_));
  }
}

/// The selected tasks of a level and their metric B.
void Hierarchy::prepare(const Stack& stack, const Selection& selection, Level& level) {
  level.given.gather(stack, selection, level.first);
  level.ready = true;
  level.factorised = false;
  if (level.given.is_motion() && stack.motion_is_y) {
    return;  // B = (1 + eps^2) I
  }
  if (level.given.is_motion()) {
    motion_.resize_for_rows(stack.size(), stack.size());
    motion_.set_rows(0, stack.motion);
  }
  multiply_rows(rows(level), level.metric);
  for (Eigen::Index i = 0; i < level.metric.rows(); ++i) {
    level.metric(i, i) += options_.epsilon * options_.epsilon;
  }
}

const PanelMatrix& Hierarchy::rows(const Level& level) const {
  return level.given.is_motion() ? motion_ : level.given.a();
}

void Hierarchy::add_level(const Stack& stack, Level& level, bool last, Solution& solution) {
  const int m = level.given.rows();
  // a level that asks for all the freedom there is always loses some to the levels above it
  const bool partial = m < stack.size();
  const int open = by_basis_ ? open_.size() : closed_.open();
  const bool crowded = open < m;
  solution.singular = solution.singular || (partial && crowded);
  if (open == 0) {
    return;
  }
  const bool plain = level.given.is_motion() && stack.motion_is_y;
  const Eigen::Index padded = PanelMatrix::padded(m);
  residual_.head(padded) = level.given.b().head(padded);
  if (plain) {
    residual_.head(padded) -= y_;
  } else {
    subtract_product(rows(level), y_.data(), residual_.data());
  }
  if (!by_basis_ && plain && plain_is_undamped() && (last || !closed_.shared())) {
    add_rest();
    return;
  }
  // the spectrum of few rows costs little even if some of them have no direction left
  const bool by_rows = partial && (!crowded || m <= PanelMatrix::height);
  if (!by_basis_ && (closed_.shared() || !by_rows)) {
    open_.reset(closed_);  // what follows needs a basis of what is open
    by_basis_ = true;
  }
  project(plain, level);
  if (partial && !crowded && add_undamped(level, last)) {
    return;
  }
  whiten(plain, level);
  const bool clear = add_whitened(last);
  solution.singular = solution.singular || (partial && !clear);
}

/// A task on y itself, to which each direction is left whole or by its own share.
void Hierarchy::add_rest() {
  const double metric = 1.0 + options_.epsilon * options_.epsilon;
  multiply(closed_.rows(), residual_.data(), step_.data());
  for (int i = 0; i < closed_.size(); ++i) {
    const double left = 1.0 - closed_.share(i);
    const double rho = left * left / metric;
    step_[i] *= 1.0 - rho / damped(rho);
  }
  y_ += residual_.head(y_.size());
  subtract_transposed_product(closed_.rows(), step_.data(), y_.data());
  closed_.close_all();
}

bool Hierarchy::plain_is_undamped() const {
  return 1.0 / (1.0 + options_.epsilon * options_.epsilon) > options_.damped_below;
}

/// A task in the directions that are open, A N or A Z.
void Hierarchy::project(bool plain, const Level& level) {
  if (!by_basis_) {
    closed_.project(rows(level), task_);
    return;
  }
  const PanelMatrix& task = plain ? open_.columns() : open_.project(rows(level), task_);
  if (&task != &task_) {
    task_.assign(task);
  }
}

/// y <- y + N^(1/2) step
void Hierarchy::move() {
  if (by_basis_) {
    add_product(open_.columns(), step_.data(), y_.data());
  } else {
    y_.head(task_.cols()) += step_.head(task_.cols());
  }
}

/// The undamped law, in which no metric matters. False, and nothing is done, unless every rho > rho_0.
bool Hierarchy::add_undamped(const Level& level, bool last) {
  multiply_rows(task_, gram_);
  subtract(gram_, options_.damped_below, level.metric, excess_);
  if (!clear_.factorise(excess_) || !factor_.factorise(gram_)) {
    return false;
  }
  if (by_basis_) {
    factor_.solve(residual_.data());
  } else {
    factor_.whiten(residual_.data());
    factor_.whiten(task_);  // its rows are orthonormal then
  }
  multiply_transposed(task_, residual_.data(), step_.data());
  move();
  if (!last) {
    by_basis_ ? open_.close(task_) : closed_.close(task_);
  }
  return true;
}

/// 1 / g(rho)
double Hierarchy::damped(double rho) const {
  const double deficit = std::max(0.0, 1.0 - rho / options_.damped_below);
  return rho + options_.damped_below * deficit * deficit;
}

/// Turns A Z and what is missing into the metric B^-1; B = (1 + eps^2) I if `plain`.
void Hierarchy::whiten(bool plain, Level& level) {
  if (plain) {
    const double weight = 1.0 / std::sqrt(1.0 + options_.epsilon * options_.epsilon);
    scale(task_, weight);
    residual_ *= weight;
    return;
  }
  if (!level.factorised) {
    level.factor.factorise(level.metric);
    level.factorised = true;
  }
  level.factor.whiten(task_);
  level.factor.whiten(residual_.data());
}

/// By the spectrum of G where some rho <= rho_0 (false then), or where there are more rows than directions are open.
bool Hierarchy::add_whitened(bool last) {
  const bool by_rows = task_.rows() < task_.cols();
  by_rows ? multiply_rows(task_, gram_) : multiply_columns(task_, gram_);
  const bool clear = !by_rows && clear_.factorise(gram_, -options_.damped_below);
  clear ? minimise() : minimise_damped();
  move();
  if (!last && clear) {
    open_.close_all();
  } else if (!last) {
    by_basis_ ? open_.close(spectrum_, shares_) : closed_.close(spectrum_, shares_);
  }
  return clear;
}

/// Least squares in all open directions.
void Hierarchy::minimise() {
  factor_.factorise(gram_);
  step_.setZero();
  multiply_transposed(task_, residual_.data(), step_.data());
  factor_.solve(step_.data());
}

/// Each direction by its own gain, with its share of what is to be closed.
void Hierarchy::minimise_damped() {
  spectrum_.compute(task_, gram_);
  spectrum_.components(task_, residual_, weights_);
  auto step = step_.head(task_.cols());
  step.setZero();
  for (int i = 0; i < spectrum_.size(); ++i) {
    const double rho = spectrum_.squared(i);
    step += weights_[i] / damped(rho) * Eigen::Map<const Vector>(spectrum_.direction(i), task_.cols());
    shares_[i] = 1.0 - std::sqrt(1.0 - smooth_step(rho / options_.locked_above));
  }
}

}  // namespace tope
