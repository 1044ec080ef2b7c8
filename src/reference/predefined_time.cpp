#include "../common/require_positive.hpp"

#include <tope/reference/predefined_time.hpp>

#include <algorithm>

namespace tope {
namespace {

/// A polynomial of s in [0, 1], with its first and second derivative.
struct Profile {
  double value;
  double slope;
  double curvature;
};

// (1, 0) and (0, 1) at s = 0 in value and slope, at rest in zero at s = 1
Profile cubic_error(double s) {
  return {1.0 + s * s * (2.0 * s - 3.0), 6.0 * s * (s - 1.0), 6.0 * (2.0 * s - 1.0)};
}
Profile cubic_rate(double s) { return {s * (1.0 + s * (s - 2.0)), 1.0 + s * (3.0 * s - 4.0), 6.0 * s - 4.0}; }

// (1, 0, 0), (0, 1, 0) and (0, 0, 1) at s = 0 in value, slope and curvature, at rest in zero at s = 1
Profile quintic_error(double s) {
  return {1.0 + s * s * s * (-10.0 + s * (15.0 - 6.0 * s)), s * s * (-30.0 + s * (60.0 - 30.0 * s)),
          s * (-60.0 + s * (180.0 - 120.0 * s))};
}
Profile quintic_rate(double s) {
  return {s * (1.0 + s * s * (-6.0 + s * (8.0 - 3.0 * s))), 1.0 + s * s * (-18.0 + s * (32.0 - 15.0 * s)),
          s * (-36.0 + s * (96.0 - 60.0 * s))};
}
Profile quintic_acceleration(double s) {
  return {0.5 * s * s * (1.0 + s * (-3.0 + s * (3.0 - s))),
          0.5 * s * (2.0 + s * (-9.0 + s * (12.0 - 5.0 * s))),
          0.5 * (2.0 + s * (-18.0 + s * (36.0 - 20.0 * s)))};
}

}  // namespace

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

double PredefinedTime::phase(double t) const {
  return std::clamp((t - start_time_) / planned_duration_, 0.0, 1.0);
}

void PredefinedTime::rate(double t, const VectorArg& error, Eigen::Ref<Vector> rate) const {
  const double s = phase(t);
  const double duration = planned_duration_;
  const double k = options_.gain;
  const Profile a = cubic_error(s);
  const Profile b = cubic_rate(s);
  // e_r' - k (e - e_r), collected by e0 and e0'
  rate = (a.slope / duration + k * a.value) * initial_error_ +
         (b.slope + k * duration * b.value) * initial_rate_ - k * error;
}

void PredefinedTime::acceleration(double t, const VectorArg& error, const VectorArg& error_rate,
                                  Eigen::Ref<Vector> acceleration) const {
  const double s = phase(t);
  const double duration = planned_duration_;
  const double k = options_.gain;
  // e_r'' - 2 k (e' - e_r') - k^2 (e - e_r), collected by e0, e0' and e0''
  const auto weight = [k, duration](const Profile& p) {
    return p.curvature / (duration * duration) + 2.0 * k * p.slope / duration + k * k * p.value;
  };
  acceleration = weight(quintic_error(s)) * initial_error_ +
                 duration * weight(quintic_rate(s)) * initial_rate_ +
                 duration * duration * weight(quintic_acceleration(s)) * initial_acceleration_ -
                 2.0 * k * error_rate - k * k * error;
}

bool PredefinedTime::off_plan(double t, const VectorArg& error, bool second_order) const {
  constexpr double least = 1e-3;  // m or rad
  constexpr double share = 0.02;  // of the initial error
  const double s = phase(t);
  const double duration = planned_duration_;
  const double a = second_order ? quintic_error(s).value : cubic_error(s).value;
  const double b = second_order ? quintic_rate(s).value : cubic_rate(s).value;
  const double c = second_order ? quintic_acceleration(s).value : 0.0;
  const double deviation = (error - a * initial_error_ - duration * b * initial_rate_ -
                            duration * duration * c * initial_acceleration_)
                               .norm();
  return deviation > least + share * initial_error_.norm();
}

void PredefinedTime::resize(int size) {
  initial_error_.setZero(size);
  initial_rate_.setZero(size);
  initial_acceleration_.setZero(size);
}

}  // namespace tope
