#pragma once

#include <tope/common/types.hpp>

#include <optional>

namespace tope {

/// Exponential convergence of a task's error, (11) of the paper: rate = -gain e.
class Exponential {
 public:
  struct Options {
    double gain = 2.0;  ///< [1/s]
  };

  Exponential() = default;
  explicit Exponential(double gain) : Exponential(Options{.gain = gain}) {}
  /// Errors: ConfigError unless the gain is positive and finite.
  explicit Exponential(const Options& options);

  void start(double /*t*/, const VectorArg& /*error*/) {}
  /// Desired rate of the error (m) at time t [s].
  void rate(double t, const VectorArg& error, Eigen::Ref<Vector> rate) const;
  /// Seconds from the start to the promised arrival: none.
  std::optional<double> duration() const { return std::nullopt; }
  void resize(int /*size*/) {}

 private:
  Options options_;
};

}  // namespace tope
