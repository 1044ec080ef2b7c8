#include <tope/task/task.hpp>

#include <utility>

namespace tope {

Task::Task(int size, int nv, Reference reference)
    : error_(Vector::Zero(size)),
      jacobian_(Matrix::Zero(size, nv)),
      feedforward_(Vector::Zero(size)),
      rate_(Vector::Zero(size)),
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

std::optional<double> Task::duration() const {
  return std::visit([](const auto& r) { return r.duration(); }, reference_);
}

}  // namespace tope
