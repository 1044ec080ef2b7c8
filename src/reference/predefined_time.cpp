#include "gain.hpp"

#include <tope/reference/predefined_time.hpp>

#include <algorithm>

namespace tope {

PredefinedTime::PredefinedTime(const Options& options) : options_(options) {
  require_positive("PredefinedTime: duration [s]", options.duration);
  require_positive("PredefinedTime: gain [1/s]", options.gain);
}

void PredefinedTime::start(double t, const VectorArg& error) {
  start_time_ = t;
  initial_error_ = error;
}

void PredefinedTime::rate(double t, const VectorArg& error, Eigen::Ref<Vector> rate) const {
  const double s = std::clamp((t - start_time_) / options_.duration, 0.0, 1.0);
  const double h = 1.0 + s * s * (2.0 * s - 3.0);
  const double h_rate = 6.0 * s * (s - 1.0) / options_.duration;
  rate = (h_rate + options_.gain * h) * initial_error_ - options_.gain * error;
}

}  // namespace tope
