#include <tope/task/task.hpp>

#include <utility>

namespace tope {

Task::Task(int size, int nv, Reference reference)
    : error_(Vector::Zero(size)),
      jacobian_(Matrix::Zero(size, nv)),
      feedforward_(Vector::Zero(size)),
      error_rate_(Vector::Zero(size)),
      drift_(Vector::Zero(size)),
      rate_(Vector::Zero(size)),
      acceleration_(Vector::Zero(size)),
      reference_(std::move(reference)) {
  std::visit([size](auto& r) { r.resize(size); }, reference_);
}

void Task::update(const RobotTerms& terms, double t) {
  evaluate(terms, t);
  if (!started_) {
    std::visit([&](auto& r) { r.start(t, error_); }, reference_);
    started_ = true;
  }
  std::visit([&](const auto& r) { r.rate(t, error_, rate_); }, reference_);
  rate_ += feedforward_;
}

void Task::update_second_order(const RobotTerms& terms, double t, const Vector& acceleration) {
  evaluate(terms, t);
  error_rate_ = -feedforward_;
  error_rate_.noalias() += jacobian_ * terms.velocity();
  evaluate_drift(terms, t);
  if (!started_) {
    acceleration_ = drift_;
    acceleration_.noalias() += jacobian_ * acceleration;
    std::visit([&](auto& r) { r.start(t, error_, error_rate_, acceleration_); }, reference_);
    started_ = true;
  }
  std::visit([&](const auto& r) { r.acceleration(t, error_, error_rate_, acceleration_); }, reference_);
  acceleration_ -= drift_;
}

std::optional<double> Task::duration() const {
  return std::visit([](const auto& r) { return r.duration(); }, reference_);
}

double Task::gain() const {
  return std::visit([](const auto& r) { return r.gain(); }, reference_);
}

}  // namespace tope
