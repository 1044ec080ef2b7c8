#pragma once

#include <tope/common/types.hpp>

#include <optional>

namespace tope {

/// Convergence at a stated time by a time base generator (Becerra et al. 2018): the error is to follow
/// e_r = a e0 + b e0' with s = (t - t0) / duration and cubic a, b that match error and rate at the start and end at
/// rest, and is steered back to it with `gain`. At first e0' = 0, so that the rate starts at zero.
///
/// Of second order, e_r = a e0 + b e0' + c e0'' with quintic a, b, c that match error, rate and acceleration at
/// the start and end at rest; a deviation from e_r decays with a double pole at -gain.
///
/// The promise is void while a limit, a bound or a higher level holds the task back. With `replan_over` > 0 the plan
/// then waits, so that the task does not push ever harder, and is made anew on release, from the present error and what
/// it asked for last, so that nothing jumps.
class PredefinedTime {
 public:
  struct Options {
    double duration = 5.0;  ///< from the first update of the task [s]
    double gain = 2.0;      ///< of the deviation from e_r [1/s]
    /// Least time for a plan made after a release [s]; else it takes what is left of `duration`. 0: never plans anew.
    double replan_over = 0.0;
  };

  PredefinedTime() = default;
  explicit PredefinedTime(double duration) : PredefinedTime(Options{.duration = duration}) {}
  /// Errors: ConfigError unless duration and gain are positive and finite, and replan_over is not negative.
  explicit PredefinedTime(const Options& options);

  /// Latches time [s], error, rate and, for the second order, acceleration (m each) of the start.
  void start(double t, const VectorArg& error, const VectorArg& rate, const VectorArg& acceleration);
  /// The same after a release, for the time that is left.
  void replan(double t, const VectorArg& error, const VectorArg& rate, const VectorArg& acceleration);
  /// Lets the plan wait for a while [s].
  void wait(double duration) { start_time_ += duration; }
  bool replans() const { return options_.replan_over > 0.0; }
  /// Desired rate of the error (m) at time t [s].
  void rate(double t, const VectorArg& error, Eigen::Ref<Vector> rate) const;
  /// Desired acceleration of the error (m) at time t [s], given the error and its rate.
  void acceleration(double t, const VectorArg& error, const VectorArg& error_rate,
                    Eigen::Ref<Vector> acceleration) const;
  /// True where the error (m) at time t [s] is off its plan by more than 2 % of where it began, and 1 mm or mrad.
  bool off_plan(double t, const VectorArg& error, bool second_order) const;
  std::optional<double> duration() const { return options_.duration; }
  double gain() const { return options_.gain; }  ///< [1/s]
  void resize(int size);

 private:
  double phase(double t) const;  // s
  void plan(double t, double duration, const VectorArg& error, const VectorArg& rate,
            const VectorArg& acceleration);

  Options options_;
  double start_time_ = 0.0;
  double planned_duration_ = 0.0;
  double deadline_ = 0.0;
  Vector initial_error_;
  Vector initial_rate_;
  Vector initial_acceleration_;
};

}  // namespace tope
