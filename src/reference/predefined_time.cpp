#include "../common/require_positive.hpp"

#include <tope/reference/predefined_time.hpp>

#include <algorithm>

namespace tope {

PredefinedTime::PredefinedTime(const Options& options) : options_(options) {
  require_positive("PredefinedTime: duration [s]", options.duration);
  require_positive("PredefinedTime: gain [1/s]", options.gain);
  if (options.replan_over != 0.0) {
    require_positive("PredefinedTime: replan_over [s]", options.replan_over);
  }
}

void PredefinedTime::start(double t, const VectorArg& error, const VectorArg& rate,
                           const VectorArg& acceleration) {
  plan(t, options_.duration, error, rate, acceleration);
  deadline_ = t + options_.duration;
}

void PredefinedTime::replan(double t, const VectorArg& error, const VectorArg& rate,
                            const VectorArg& acceleration) {
  plan(t, std::max(deadline_ - t, options_.replan_over), error, rate, acceleration);
}

void PredefinedTime::plan(double t, double duration, const VectorArg& error, const VectorArg& rate,
                          const VectorArg& acceleration) {
  start_time_ = t;
  planned_duration_ = duration;
  initial_error_ = error;
  initial_rate_ = rate;
  initial_acceleration_ = acceleration;
}

void PredefinedTime::rate(double t, const VectorArg& error, Eigen::Ref<Vector> rate) const {
  const double duration = planned_duration_;
  const double s = std::clamp((t - start_time_) / duration, 0.0, 1.0);
  const double a = 1.0 + s * s * (2.0 * s - 3.0);
  const double a1 = 6.0 * s * (s - 1.0);
  const double b = s * (1.0 + s * (s - 2.0));
  const double b1 = 1.0 + s * (3.0 * s - 4.0);
  rate = (a1 / duration + options_.gain * a) * initial_error_ +
         (b1 + options_.gain * duration * b) * initial_rate_ - options_.gain * error;
}

void PredefinedTime::resize(int size) {
  initial_error_.setZero(size);
  initial_rate_.setZero(size);
  initial_acceleration_.setZero(size);
}

void PredefinedTime::acceleration(double t, const VectorArg& error, const VectorArg& error_rate,
                                  Eigen::Ref<Vector> acceleration) const {
  const double duration = planned_duration_;
  const double s = std::clamp((t - start_time_) / duration, 0.0, 1.0);
  // each profile with its first and second derivative with respect to s
  const double a = 1.0 + s * s * s * (-10.0 + s * (15.0 - 6.0 * s));
  const double a1 = s * s * (-30.0 + s * (60.0 - 30.0 * s));
  const double a2 = s * (-60.0 + s * (180.0 - 120.0 * s));
  const double b = s * (1.0 + s * s * (-6.0 + s * (8.0 - 3.0 * s)));
  const double b1 = 1.0 + s * s * (-18.0 + s * (32.0 - 15.0 * s));
  const double b2 = s * (-36.0 + s * (96.0 - 60.0 * s));
  const double c = 0.5 * s * s * (1.0 + s * (-3.0 + s * (3.0 - s)));
  const double c1 = 0.5 * s * (2.0 + s * (-9.0 + s * (12.0 - 5.0 * s)));
  const double c2 = 0.5 * (2.0 + s * (-18.0 + s * (36.0 - 20.0 * s)));

  // acceleration = e_r'' - 2 k (e' - e_r') - k^2 (e - e_r), collected by e0, e0' and e0''
  const double k = options_.gain;
  const auto weight = [k, duration](double p, double p1, double p2) {
    return p2 / (duration * duration) + 2.0 * k * p1 / duration + k * k * p;
  };
  acceleration = weight(a, a1, a2) * initial_error_ + duration * weight(b, b1, b2) * initial_rate_ +
                 duration * duration * weight(c, c1, c2) * initial_acceleration_ - 2.0 * k * error_rate -
                 k * k * error;
}

}  // namespace tope
