#pragma once

#include <tope/controller/controller.hpp>

#include <cmath>
#include <utility>

namespace tope::test {

/// A controller and a robot that follows its velocity commands exactly.
struct Loop {
  Loop(Robot described, const ControllerOptions& options)
      : robot(std::move(described)), controller(robot, options) {
    q << 0.0, 0.0, 0.0, 0.0, 0.4, 0.9, 0.6, 1.8;
  }

  void step() {
    controller.update(q, u, t, u);
    q += controller.options().dt * u;
    t += controller.options().dt;
  }

  void run(double duration) {
    run(duration, [] {});
  }

  /// Calls `observe` after each cycle.
  template <typename Observe>
  void run(double duration, Observe observe) {
    for (auto cycles = std::lround(duration / controller.options().dt); cycles > 0; --cycles) {
      step();
      observe();
    }
  }

  /// Largest distance beyond a limit; negative: distance kept.
  double beyond() const {
    return (q - robot.position_upper()).cwiseMax(robot.position_lower() - q).maxCoeff();
  }

  Robot robot;
  Controller controller;
  Vector q = Vector::Zero(8);
  Vector u = Vector::Zero(8);
  double t = 0.0;
};

}  // namespace tope::test
