// Run: build/Release/examples/example_05_moving_target        Twin: 05_moving_target.py
// The gripper follows a point that swings to and fro. Told where the point is, it lags behind; told its velocity too, it
// does not.
#include <tope/controller/controller.hpp>
#include <tope/task/frame_position.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

namespace {

constexpr double gain = 4.0;  // [1/s]

/// Largest distance from the point, once the start is forgotten.
double largest_error(const tope::Robot& robot, const tope::Target<tope::PointTarget>& target) {
  const double dt = 1e-3;
  tope::Controller controller{robot, {.mode = tope::Mode::velocity, .dt = dt}};
  const auto reach = controller.add(1, tope::FramePosition{robot, "ee", target, tope::Exponential{gain}});
  tope::Vector q(robot.nq());
  q << 0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8;
  tope::Vector v = tope::Vector::Zero(robot.nv());
  double error = 0.0;
  for (int cycle = 0; cycle < 8000; ++cycle) {
    controller.update(q, v, cycle * dt, v);
    q += dt * v;
    if (cycle >= 4000) {
      error = std::max(error, controller.task(reach).error().norm());
    }
  }
  return error;
}

}  // namespace

int main() {
  const auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");
  const tope::Vector3 amplitude(0.0, 0.15, 0.05);
  const double frequency = 0.25;  // [Hz]
  const auto swinging = tope::moving_along_sine(tope::Vector3(0.6, 0.1, 0.3), amplitude, frequency);
  const std::function<tope::PointTarget(double)> without_velocity = [&](double t) {
    return tope::PointTarget{.position = swinging.at(t).position};
  };

  const double lag = largest_error(robot, tope::Target<tope::PointTarget>(without_velocity));
  const double left = largest_error(robot, swinging);
  const double rate = 2.0 * std::numbers::pi * frequency;
  const double expected = rate * amplitude.norm() / std::hypot(gain, rate);
  std::printf("largest error without the velocity %.2f mm, %.2f expected; with it %.3f\n", 1e3 * lag,
              1e3 * expected, 1e3 * left);
  return std::abs(lag - expected) < 0.01 * expected && left < 1e-3 ? 0 : 1;
}
