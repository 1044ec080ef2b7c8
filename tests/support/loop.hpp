#pragma once

#include <tope/controller/controller.hpp>
#include <tope/plant/rigid_body.hpp>

#include <cmath>
#include <optional>
#include <utility>

namespace tope::test {

/// A controller and a robot that follows its velocity commands exactly, or a rigid body under its torques.
struct Loop {
  /// A youBot with its arm bent.
  Loop(Robot described, const ControllerOptions& options)
      : Loop(std::move(described), options,
             (Vector(8) << 0.0, 0.0, 0.0, 0.0, 0.4, 0.9, 0.6, 1.8).finished()) {}

  Loop(Robot described, const ControllerOptions& options, const Vector& start)
      : robot(std::move(described)),
        controller(robot, options),
        q(start),
        v(Vector::Zero(robot.nv())),
        u(Vector::Zero(robot.nv())) {
    if (options.mode == Mode::torque) {
      body.emplace(robot, RigidBodyOptions{}, options.dt);
      body->reset(q);
    }
  }

  void step() {
    command();
    follow();
  }

  void command() { controller.update(q, v, t, u); }

  /// Moves the robot; a rigid body may touch the heap.
  void follow() {
    const double dt = controller.options().dt;
    if (body) {
      body->step(u, dt);
      q = body->position();
      v = body->velocity();
    } else {
      q += dt * u;
      v = u;
    }
    t += dt;
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
  std::optional<RigidBody> body;  // in torque mode
  Vector q;
  Vector v;
  Vector u;
  double t = 0.0;
};

}  // namespace tope::test
