#pragma once

#include <tope/common/types.hpp>

#include <optional>

namespace tope {

/// Convergence at a stated time by a time base generator (Becerra et al. 2018): the error is to follow
/// e_r = h(s) e0 with s = (t - t0) / duration and h = 1 - 3 s^2 + 2 s^3, and is steered back to it with
/// `gain`. The rate is continuous at both ends, and zero at the start.
///
/// Of second order, e_r = a e0 + b e0' + c e0'' with quintic a, b, c that match error, rate and acceleration at
/// the start and end at rest; a deviation from e_r decays with a double pole at -gain.
class PredefinedTime {
 public:
  struct Options {
    double duration = 5.0;  ///< from the first update of the task [s]
    double gain = 2.0;      ///< of the deviation from e_r [1/s]
  };

  PredefinedTime() = default;
  explicit PredefinedTime(double duration) : PredefinedTime(Options{.duration = duration}) {}
  /// Errors: ConfigError unless duration and gain are positive and finite.
  explicit PredefinedTime(const Options& options);

  /// Latches time [s] and error (m) of the start.
  void start(double t, const VectorArg& error);
  /// And its rate and acceleration, for the second order.
  void start(double t, const VectorArg& error, const VectorArg& rate, const VectorArg& acceleration);
  /// Desired rate of the error (m) at time t [s].
  void rate(double t, const VectorArg& error, Eigen::Ref<Vector> rate) const;
  /// Desired acceleration of the error (m) at time t [s], given the error and its rate.
  void acceleration(double t, const VectorArg& error, const VectorArg& error_rate,
                    Eigen::Ref<Vector> acceleration) const;
  std::optional<double> duration() const { return options_.duration; }
  double gain() const { return options_.gain; }  ///< [1/s]
  void resize(int size);

 private:
  Options options_;
  double start_time_ = 0.0;
  Vector initial_error_;
  Vector initial_rate_;
  Vector initial_acceleration_;
};

}  // namespace tope
