#pragma once

#include <tope/common/types.hpp>

#include <vector>

namespace tope {

/// How smoothly a run moves over its last half, from the state at the start of each cycle.
class Smoothness {
 public:
  Smoothness(int joints, int tasks, int cycles, double dt);

  /// The next state: velocities v (n), and the error of each task.
  void observe(const Vector& v, const std::vector<Vector>& errors);

  /// Total variation of each joint's velocity (n).
  const Vector& velocity_variation() const { return variation_; }
  /// Root mean square of the second derivative of a task's error [m/s2 or rad/s2]. Where the target stands still, that
  /// is the acceleration of the task's frame.
  double acceleration(int task) const;

 private:
  int first_;  // state that is counted
  double dt_;
  int states_ = 0;
  Vector variation_;
  Vector last_velocity_;
  std::vector<Vector> last_errors_;
  std::vector<Vector> errors_before_;
  std::vector<double> squares_;
  int counted_ = 0;
};

}  // namespace tope
