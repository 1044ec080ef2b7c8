#include <tope/scenario/smoothness.hpp>

#include <cmath>

namespace tope {

Smoothness::Smoothness(int joints, int tasks, int cycles, double dt)
    : first_((cycles + 1) / 2),
      dt_(dt),
      variation_(Vector::Zero(joints)),
      squares_(static_cast<std::size_t>(tasks), 0.0) {}

void Smoothness::observe(const Vector& v, const std::vector<Vector>& errors) {
  if (states_ >= first_ && states_ >= 2) {
    variation_ += (v - last_velocity_).cwiseAbs();
    for (std::size_t i = 0; i < errors.size(); ++i) {
      squares_[i] += ((errors[i] - 2.0 * last_errors_[i] + errors_before_[i]) / (dt_ * dt_)).squaredNorm();
    }
    ++counted_;
  }
  ++states_;
  last_velocity_ = v;
  errors_before_ = std::move(last_errors_);
  last_errors_ = errors;
}

double Smoothness::acceleration(int task) const {
  return counted_ == 0 ? 0.0 : std::sqrt(squares_[static_cast<std::size_t>(task)] / counted_);
}

}  // namespace tope
