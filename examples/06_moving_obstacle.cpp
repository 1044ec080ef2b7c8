// Run: build/Release/examples/example_06_moving_obstacle        Twin: 06_moving_obstacle.py
// A wall drives at the base and away again. The base gives way and comes back; the gripper stays where it is,
// since the base's place is a lower level.
#include <tope/controller/controller.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_position.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace {

/// Limits of base_x before the wall at time t.
tope::LimitMotion wall(double t) {
  const double rate = 2.0 * std::numbers::pi / 10.0;
  return {.lower = -50.0,
          .upper = 0.05 + 0.2 * std::cos(rate * t),
          .upper_rate = -0.2 * rate * std::sin(rate * t)};
}

}  // namespace

int main() {
  const auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");
  const int base_x = robot.joint_index("base_x");
  const double dt = 1e-3;
  tope::Controller controller{robot, {.mode = tope::Mode::velocity, .dt = dt}};
  const auto hold = controller.add(
      1, tope::FramePosition{robot, "ee", tope::Vector3(0.45, 0.0, 0.3), tope::Exponential{10.0}});
  controller.add(2, tope::JointPosition{robot, {{"base_x", 0.0}}});

  tope::Vector q(robot.nq());
  q << 0, 0, 0, 0, 0.2, 0.9, 1.2, 0.3;
  tope::Vector v = tope::Vector::Zero(robot.nv());
  double room = 1.0, pushed_to = 1.0, error = 0.0;
  for (int cycle = 0; cycle < 20000; ++cycle) {
    if (!controller.move_limits(base_x, wall(cycle * dt))) {
      return 1;  // it would have left the limits as they are
    }
    controller.update(q, v, cycle * dt, v);
    q += dt * v;
    pushed_to = std::min(pushed_to, q[base_x]);
    room = std::min(room, wall((cycle + 1) * dt).upper - q[base_x]);
    if (cycle >= 5000) {
      error = std::max(error, controller.task(hold).error().norm());
    }
  }

  std::printf("least distance from the wall %.2f mm, base_x pushed to %.3f m\n", 1e3 * room, pushed_to);
  std::printf("gripper within %.3f mm of its place from 5 s on\n", 1e3 * error);
  return room > 0.0 && pushed_to < -0.14 && error < 1e-3 ? 0 : 1;
}
