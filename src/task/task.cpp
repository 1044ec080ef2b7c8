#include <tope/task/task.hpp>

#include <utility>

namespace tope {
namespace {

constexpr double kNothing = 1e-3;  // a task that misses less than this is not held [its rate or acceleration]

}  // namespace

Task::Task(int size, int nv, Reference reference)
    : error_(Vector::Zero(size)),
      jacobian_(Matrix::Zero(size, nv)),
      feedforward_(Vector::Zero(size)),
      error_rate_(Vector::Zero(size)),
      drift_(Vector::Zero(size)),
      rate_(Vector::Zero(size)),
      acceleration_(Vector::Zero(size)),
      served_(Vector::Zero(size)),
      reference_(std::move(reference)),
      duration_(std::visit([](const auto& r) { return r.duration(); }, reference_)) {
  std::visit([size](auto& r) { r.resize(size); }, reference_);
}

void Task::restart() {
  started_ = false;
  held_ = false;
  released_ = false;
}

/// Starts the reference, lets it wait while the task is held, or plan anew after a release.
void Task::start_reference(double t, const Vector& rate, const Vector& acceleration) {
  if (!started_) {
    std::visit([&](auto& r) { r.start(t, error_, rate, acceleration); }, reference_);
    started_ = true;
  } else if (held_ && replans()) {
    std::visit([&](auto& r) { r.wait(t - last_time_); }, reference_);
  } else if (released_) {
    std::visit([&](auto& r) { r.replan(t, error_, rate, acceleration); }, reference_);
  }
  released_ = false;
  last_time_ = t;
}

void Task::update(const RobotTerms& terms, double t) {
  second_order_ = false;
  evaluate(terms, t);
  if (started_) {
    rate_ -= feedforward_;  // what the error was asked to do last
  } else {
    rate_.setZero();
  }
  start_reference(t, rate_, acceleration_);
  std::visit([&](const auto& r) { r.rate(t, error_, rate_); }, reference_);
  rate_ += feedforward_;
}

/// Error rate and drift, after evaluate().
void Task::find_drift(const RobotTerms& terms, double t) {
  error_rate_ = -feedforward_;
  error_rate_.noalias() += jacobian_ * terms.velocity();
  evaluate_drift(terms, t);
}

void Task::update_second_order(const RobotTerms& terms, double t, const Vector& acceleration) {
  second_order_ = true;
  evaluate(terms, t);
  find_drift(terms, t);
  if (started_) {
    acceleration_ += drift_;  // what the error was asked to do last
  } else {
    acceleration_ = drift_;
    acceleration_.noalias() += jacobian_ * acceleration;
  }
  start_reference(t, error_rate_, acceleration_);
  std::visit([&](const auto& r) { r.acceleration(t, error_, error_rate_, acceleration_); }, reference_);
  acceleration_ -= drift_;
}

void Task::observe(const Vector& motion) {
  constexpr double held_below = 0.5;       // of what the task asks for
  constexpr double released_above = 0.75;  // apart, so that the state does not flicker
  const Vector& asked = second_order_ ? acceleration_ : rate_;
  served_.noalias() = jacobian_ * motion;
  const double missing = (asked - served_).norm();
  const double size = asked.norm();
  const bool was_held = held_;
  const bool underserved = missing > (1.0 - (was_held ? released_above : held_below)) * size + kNothing;
  held_ =
      underserved &&
      std::visit([&](const auto& r) { return r.off_plan(last_time_, error_, second_order_); }, reference_);
  released_ = replans() && was_held && !held_;
}

bool Task::replans() const {
  return std::visit([](const auto& r) { return r.replans(); }, reference_);
}

double Task::gain() const {
  return std::visit([](const auto& r) { return r.gain(); }, reference_);
}

}  // namespace tope
