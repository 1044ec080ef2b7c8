#include <tope/scenario/metrics.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tope {
namespace {

double percentile(const std::vector<double>& sorted, double fraction) {
  if (sorted.empty()) {
    return 0.0;
  }
  const auto index = static_cast<std::size_t>(std::lround(fraction * static_cast<double>(sorted.size() - 1)));
  return sorted[index];
}

}  // namespace

Metrics::Metrics(Vector lower, Vector upper, Vector buffer, Vector bound, std::vector<TaskInfo> tasks,
                 int cycles, double dt)
    : lower_(std::move(lower)),
      upper_(std::move(upper)),
      buffer_(std::move(buffer)),
      bound_(std::move(bound)),
      tasks_(std::move(tasks)),
      planned_cycles_(cycles),
      dt_(dt) {
  const Eigen::Index n = lower_.size();
  summary_.limit_violation = Vector::Constant(n, -std::numeric_limits<double>::infinity());
  summary_.command_jump = Vector::Zero(n);
  summary_.command_variation = Vector::Zero(n);
  summary_.buffer_time = Vector::Zero(n);
  cycle_times_.reserve(static_cast<std::size_t>(cycles));
}

void Metrics::move_limits(const Vector& lower, const Vector& upper) {
  lower_ = lower;
  upper_ = upper;
}

void Metrics::observe(double t, const Vector& q, const Vector& u, const std::vector<double>& errors,
                      const Status& status, double cycle_time_us) {
  observe_state(t, q, errors);
  const int cycle = summary_.cycles++;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    if (std::min(q[j] - lower_[j], upper_[j] - q[j]) < buffer_[j]) {
      summary_.buffer_time[j] += dt_;
    }
    if (cycle > 0) {
      const double change = std::abs(u[j] - last_command_[j]);
      summary_.command_jump[j] = std::max(summary_.command_jump[j], change / bound_[j]);
      summary_.command_variation[j] += 2 * cycle >= planned_cycles_ ? change : 0.0;
    }
  }
  last_command_ = u;
  for (const Event event : all_events) {
    if (status.has(event)) {
      ++summary_.status_counts[std::string(to_string(event))];
    }
  }
  if (status.ok()) {
    ++summary_.status_counts["ok"];
  }
  cycle_times_.push_back(cycle_time_us);
}

void Metrics::observe_end(double t, const Vector& q, const std::vector<double>& errors) {
  observe_state(t, q, errors);
}

void Metrics::observe_state(double t, const Vector& q, const std::vector<double>& errors) {
  summary_.limit_violation = summary_.limit_violation.cwiseMax((q - upper_).cwiseMax(lower_ - q));
  bool reached = true;
  bool any_goal = false;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    TaskResult& result = summary_.tasks[tasks_[i].name];
    result.final_error = errors[i];
    const std::optional<double>& goal_time = tasks_[i].goal_time;
    if (goal_time.has_value() && !result.at_goal_time.has_value() && t >= *goal_time - 0.5 * dt_) {
      result.at_goal_time = errors[i];
    }
    reached = reached && (!tasks_[i].goal || errors[i] < tasks_[i].tolerance);
    any_goal = any_goal || tasks_[i].goal;
  }
  if (!reached || !any_goal) {
    reached_since_.reset();
  } else if (!reached_since_) {
    reached_since_ = t;
  }
}

Summary Metrics::summary() const {
  Summary summary = summary_;
  for (Eigen::Index j = 0; j < lower_.size(); ++j) {
    if (!std::isfinite(summary.limit_violation[j])) {
      summary.limit_violation[j] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  summary.time_to_goal = reached_since_;
  std::vector<double> times = cycle_times_;
  std::sort(times.begin(), times.end());
  summary.cycle_time_us = {percentile(times, 0.5), percentile(times, 0.99), percentile(times, 0.999),
                           percentile(times, 1.0)};
  return summary;
}

}  // namespace tope
