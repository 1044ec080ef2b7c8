#pragma once

#include <tope/common/types.hpp>

#include <optional>

namespace tope {

/// Exponential convergence of a task's error: rate = -gain e, (11) of the paper, or of second order with a double pole
/// at -gain, acceleration = -gain^2 e - 2 gain e_rate, (12).
class Exponential {
 public:
  struct Options {
    double gain = 2.0;  ///< [1/s]
  };

  Exponential() = default;
  explicit Exponential(double gain) : Exponential(Options{.gain = gain}) {}
  /// Errors: ConfigError unless the gain is positive and finite.
  explicit Exponential(const Options& options);

  void start(double /*t*/, const VectorArg& /*error*/, const VectorArg& /*rate*/,
             const VectorArg& /*acceleration*/) {}
  void replan(double /*t*/, const VectorArg& /*error*/, const VectorArg& /*rate*/,
              const VectorArg& /*acceleration*/) {}
  void wait(double /*duration*/) {}
  bool replans() const { return false; }
  /// Desired rate of the error (m) at time t [s].
  void rate(double t, const VectorArg& error, Eigen::Ref<Vector> rate) const;
  /// Desired acceleration of the error (m) at time t [s], given the error and its rate.
  void acceleration(double t, const VectorArg& error, const VectorArg& error_rate,
                    Eigen::Ref<Vector> acceleration) const;
  bool off_plan(double /*t*/, const VectorArg& /*error*/, bool /*second_order*/) const { return false; }
  /// Seconds from the start to the promised arrival: none.
  std::optional<double> duration() const { return std::nullopt; }
  double gain() const { return options_.gain; }  ///< [1/s]
  void resize(int /*size*/) {}

 private:
  Options options_;
};

}  // namespace tope
