#include "panel_columns.hpp"

#include <tope/common/error.hpp>
#include <tope/law/hierarchy.hpp>
#include <tope/law/smooth_step.hpp>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

int workspace_rows(const Stack& stack) { return std::max(stack.size(), stack.max_level_rows()); }

/// True when some level asks for all freedom, and not for y itself.
bool has_full_level(const Stack& stack) {
  const auto fills = [&](const TaskRows& task) {
    Eigen::Index rows = 0;
    for (const TaskRows& other : stack.tasks) {
      rows += other.level == task.level ? other.b.size() : 0;
    }
    return rows >= stack.size();
  };
  return !stack.motion_is_y && std::any_of(stack.tasks.begin(), stack.tasks.end(), fills);
}

}  // namespace

Hierarchy::Hierarchy(const Stack& stack, const Options& options)
    : options_(options),
      needs_basis_(has_full_level(stack)),
      limits_(stack.size(), needs_basis_),
      tasks_(stack.tasks.size(), 0),
      closed_(stack.size(), workspace_rows(stack)),
      open_(stack.size()),
      motion_(stack.size(), stack.size()),
      task_(workspace_rows(stack), stack.size()),
      gram_(workspace_rows(stack), workspace_rows(stack)),
      factor_(stack.size()),
      clear_(stack.size()),
      eigen_(stack.size()),
      spectrum_(stack.size(), stack.size()),
      y_(Vector::Zero(PanelMatrix::padded(stack.size()))),
      residual_(Vector::Zero(PanelMatrix::padded(workspace_rows(stack)))),
      weights_(residual_),
      step_(y_),
      shares_(y_) {
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
    levels_.emplace_back(stack.size(), static_cast<int>(rows));
    ranges_.push_back({first, last});
    empty_.push_back(1);
    first = last;
  }
}

void Hierarchy::begin() {
  for (HierarchyLevel& level : levels_) {
    level.forget();
  }
  limits_.release();
  shared_ = 0;
}

void Hierarchy::solve(const Stack& stack, const Selection& selection, Solution& solution) {
  solve(stack, selection, stack.limit_target, solution);
}

void Hierarchy::solve(const Stack& stack, const Selection& selection, const Vector& limit_target,
                      Solution& solution) {
  solution.begin();
  select_tasks(selection);
  hold_limits(stack, selection);
  limits_.meet(limit_target, y_);
  solution.y_limits = y_.head(stack.size());
  by_basis_ = needs_basis_;
  if (by_basis_) {
    open_.reset(limits_.open());
  } else if (shared_ == 0) {
    closed_.reset(limits_.closed());
  }
  const std::size_t known = shared_;
  shared_ = needs_basis_ ? 0 : levels_.size();
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    if (empty_[i] != 0) {
      continue;
    }
    if (!levels_[i].ready()) {
      prepare(stack, selection, ranges_[i].first, levels_[i]);
    }
    const bool last = i + 1 == levels_.size();
    if (i + 1 < known) {
      add_known(levels_[i], solution);
    } else if (!add_level(stack, levels_[i], i < known, last, solution)) {
      shared_ = std::min(shared_, i + 1);
    }
  }
  solution.y = y_.head(stack.size());
}

/// A level that has other tasks than in the selection before is gathered anew.
void Hierarchy::select_tasks(const Selection& selection) {
  if (selection.tasks == tasks_) {
    return;
  }
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    empty_[i] = 1;
    for (std::size_t task = ranges_[i].first; task < ranges_[i].last; ++task) {
      if (selection.tasks[task] != tasks_[task]) {
        levels_[i].forget();
      }
      if (selection.tasks[task] != 0) {
        empty_[i] = 0;
      }
    }
  }
  tasks_ = selection.tasks;
  shared_ = 0;
}

/// Level 0. The selections of a chain grow: what is held already stays.
void Hierarchy::hold_limits(const Stack& stack, const Selection& selection) {
  if (!limits_.within(selection)) {
    limits_.release();
    shared_ = 0;
  }
  for (Eigen::Index joint = 0; joint < stack.size(); ++joint) {
    if (selection.limits[static_cast<std::size_t>(joint)] != 0 && !limits_.holds(joint)) {
      close_in_shared_levels(limits_.hold(stack, joint));
    }
  }
}

/// Down to the first level that the direction moves and that is damped: below it more has changed.
void Hierarchy::close_in_shared_levels(const Vector& direction) {
  step_ = direction;
  for (std::size_t i = 0; i < shared_; ++i) {
    if (empty_[i] != 0) {
      continue;
    }
    if (!levels_[i].close(step_.data(), options_.damped_below)) {
      shared_ = i + 1;
    }
  }
}

/// The selected tasks of a level and their metric B.
void Hierarchy::prepare(const Stack& stack, const Selection& selection, std::size_t first,
                        HierarchyLevel& level) {
  level.gather(stack, selection, first);
  if (level.given().is_motion() && stack.motion_is_y) {
    return;  // B = (1 + eps^2) I
  }
  if (level.given().is_motion()) {
    motion_.resize(stack.size(), stack.size());
    motion_.set_rows(0, stack.motion);
  }
  level.set_metric(rows(level), options_.epsilon);
}

const PanelMatrix& Hierarchy::rows(const HierarchyLevel& level) const {
  return level.given().is_motion() ? motion_ : level.given().a();
}

/// A level that takes from those below, which are known too, just what it took in the selection before.
void Hierarchy::add_known(HierarchyLevel& level, Solution& solution) {
  find_residual(level, false);
  if (level.clear()) {
    add_clear(level, false);
  } else {
    minimise_by_rows(level);
    solution.singular = true;
  }
}

/// True when what is closed below the level is known as rows. `shared`: A N is known from the selection before.
bool Hierarchy::add_level(const Stack& stack, HierarchyLevel& level, bool shared, bool last,
                          Solution& solution) {
  const bool plain = level.given().is_motion() && stack.motion_is_y;
  if (shared && level.clear()) {  // the last level
    find_residual(level, plain);
    add_clear(level, false);
    return true;
  }
  shared ? restore_closed(level) : level.start(closed_.size());
  const int m = level.given().rows();
  // a level that asks for all the freedom there is always loses some to the levels above it
  const bool partial = m < stack.size();
  const int open = by_basis_ ? open_.size() : closed_.open();
  const bool crowded = open < m;
  solution.singular = solution.singular || (partial && crowded);
  if (open == 0) {
    return false;
  }
  find_residual(level, plain);
  if (!by_basis_ && plain && plain_is_undamped() && (last || !closed_.shared())) {
    add_rest();
    return false;
  }
  // the spectrum of few rows costs little even if some of them have no direction left
  const bool few = partial && (!crowded || m <= PanelMatrix::height);
  if (!by_basis_ && (closed_.shared() || !few)) {
    open_.reset(closed_);  // what follows needs a basis of what is open
    by_basis_ = true;
    shared = false;
  }
  if (!by_basis_ || (partial && !crowded)) {
    if (!shared) {
      project(level);
      if (!crowded && level.factorise(options_.damped_below)) {
        add_clear(level, !last);
        return !by_basis_;
      }
    }
    if (!by_basis_ || m < open) {
      add_by_rows(level, last);
      solution.singular = true;
      return !by_basis_;
    }
  }
  const bool clear = add_by_columns(level, plain, last);
  solution.singular = solution.singular || (partial && !clear);
  return false;
}

/// b - A y
void Hierarchy::find_residual(const HierarchyLevel& level, bool plain) {
  if (plain) {
    residual_.head(y_.size()) = level.given().b().head(y_.size()) - y_;
  } else {
    subtract_product(level.given().b().data(), rows(level), y_.data(), residual_.data());
  }
}

/// What is closed above a level of which A N is known, as rows.
void Hierarchy::restore_closed(const HierarchyLevel& level) {
  closed_.keep(level.closed_before());
  for (int i = 0; i < level.closed_since(); ++i) {
    closed_.close(level.closed_direction(i));
  }
}

/// A task on y itself, to which each direction is left whole or by its own share.
void Hierarchy::add_rest() {
  const double metric = 1.0 + options_.epsilon * options_.epsilon;
  multiply(closed_.rows(), residual_.data(), step_.data());
  for (Eigen::Index p = 0; closed_.shared() && p < closed_.rows().panels(); ++p) {
    const Column left = Column::Ones() - column(closed_.shares().data(), p);
    const Column rho = left.cwiseProduct(left) / metric;
    column(step_.data(), p) -= column(step_.data(), p).cwiseProduct(rho).cwiseQuotient(damped(rho));
  }
  y_ += residual_.head(y_.size());
  subtract_transposed_product(closed_.rows(), step_.data(), y_.data());
  closed_.close_all();
}

bool Hierarchy::plain_is_undamped() const {
  return 1.0 / (1.0 + options_.epsilon * options_.epsilon) > options_.damped_below;
}

/// A task in the directions that are open, A N or A Z, with its Gram matrix.
void Hierarchy::project(HierarchyLevel& level) {
  if (by_basis_) {
    level.set_projected(open_.project(rows(level), level.workspace()));
  } else {
    level.project(rows(level), closed_);
  }
}

/// The undamped law, in which no metric matters.
void Hierarchy::add_clear(const HierarchyLevel& level, bool to_be_closed) {
  level.factor().solve(residual_.data());
  multiply_transposed(level.projected(), residual_.data(), step_.data());
  move();
  if (!to_be_closed) {
    return;
  }
  if (by_basis_) {
    open_.close(level.projected());
  } else {
    task_.assign(level.projected());
    level.factor().whiten(task_);  // its rows are orthonormal then
    closed_.close(task_);
  }
}

/// By the spectrum of G, of which some rho <= rho_0.
void Hierarchy::add_by_rows(HierarchyLevel& level, bool last) {
  const RowSpectrum& spectrum = minimise_by_rows(level);
  if (!last) {
    close_shares(spectrum);
  }
}

const RowSpectrum& Hierarchy::minimise_by_rows(HierarchyLevel& level) {
  RowSpectrum& spectrum = level.decompose(eigen_);
  level.metric().whiten(residual_.data());
  minimise_damped(spectrum, level.projected());
  return spectrum;
}

/// Where there are as many rows as open directions or more. True when every rho > rho_0.
bool Hierarchy::add_by_columns(HierarchyLevel& level, bool plain, bool last) {
  whiten_columns(level, plain);
  multiply_columns(task_, gram_);
  if (!clear_.positive_definite(gram_, -options_.damped_below)) {
    spectrum_.compute(task_, gram_, eigen_);
    minimise_damped(spectrum_, task_);
    if (!last) {
      close_shares(spectrum_);
    }
    return false;
  }
  minimise();
  if (!last) {
    open_.close_all();
  }
  return true;
}

/// L^-1 A Z and what is missing in the metric B^-1; B = (1 + eps^2) I if `plain`.
void Hierarchy::whiten_columns(HierarchyLevel& level, bool plain) {
  if (plain) {
    const double weight = 1.0 / std::sqrt(1.0 + options_.epsilon * options_.epsilon);
    task_.assign(open_.columns());
    scale(task_, weight);
    residual_ *= weight;
    return;
  }
  const PanelMatrix& task = open_.project(rows(level), task_);
  if (&task != &task_) {
    task_.assign(task);
  }
  level.metric().whiten(task_);
  level.metric().whiten(residual_.data());
}

/// Least squares in all open directions.
void Hierarchy::minimise() {
  factor_.factorise(gram_);
  step_.setZero();
  multiply_transposed(task_, residual_.data(), step_.data());
  factor_.solve(step_.data());
  move();
}

/// Each direction by its own gain, with its share of what is to be closed.
void Hierarchy::minimise_damped(RowSpectrum& spectrum, const PanelMatrix& rows) {
  spectrum.components(rows, residual_, weights_);
  for (Eigen::Index p = 0; p < spectrum.directions().panels(); ++p) {
    const Column rho = column(spectrum.squared().data(), p);
    column(weights_.data(), p) = column(weights_.data(), p).cwiseQuotient(damped(rho));
    column(shares_.data(), p) = 1.0 - (1.0 - smooth_step(rho.array() / options_.locked_above)).sqrt();
  }
  multiply_transposed(spectrum.directions(), weights_.data(), step_.data());
  move();
}

void Hierarchy::close_shares(const RowSpectrum& spectrum) {
  by_basis_ ? open_.close(spectrum, shares_) : closed_.close(spectrum, shares_);
}

/// y <- y + N^(1/2) step
void Hierarchy::move() {
  if (by_basis_) {
    add_product(open_.columns(), step_.data(), y_.data());
  } else {
    y_.head(closed_.rows().cols()) += step_.head(closed_.rows().cols());
  }
}

/// 1 / g(rho)
Column Hierarchy::damped(const Column& rho) const {
  const Column deficit = (Column::Ones() - rho / options_.damped_below).cwiseMax(0.0);
  return rho + options_.damped_below * deficit.cwiseProduct(deficit);
}

}  // namespace tope
