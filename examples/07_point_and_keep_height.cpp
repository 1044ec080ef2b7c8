// Run: build/Release/examples/example_07_point_and_keep_height        Twin: 07_point_and_keep_height.py
// The gripper points at a thing that goes round, as a camera would, and keeps its height: one row of a position.
// Its posture takes what these leave, so that the joints are the same after each round.
#include <tope/controller/controller.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/pointing.hpp>
#include <tope/task/posture.hpp>
#include <tope/task/selected_rows.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

int main() {
  const auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");
  const double dt = 1e-3;
  const int round = 5000;  // cycles
  const std::function<tope::PointTarget(double)> thing = [&](double t) {
    const double rate = 2.0 * std::numbers::pi / (round * dt);
    const double c = 0.3 * std::cos(rate * t);
    const double s = 0.3 * std::sin(rate * t);
    return tope::PointTarget{.position = {1.5 + c, s, 0.2}, .velocity = {-rate * s, rate * c, 0.0}};
  };

  tope::Vector q(robot.nq());
  q << 0, 0, 0, 0, 0.3, 0.5, 0.5, 0.0;
  tope::Controller controller{robot, {.mode = tope::Mode::velocity, .dt = dt}};
  const auto point = controller.add(
      1, tope::Pointing{robot, "ee", tope::Vector3::UnitZ(), tope::Target<tope::PointTarget>(thing)});
  const tope::FramePosition position{robot, "ee", tope::Vector3(0.0, 0.0, 0.4)};
  const auto keep = controller.add(2, tope::SelectedRows{position, {2}});
  controller.add(3, tope::Posture{robot, q});

  tope::Vector v = tope::Vector::Zero(robot.nv());
  tope::Vector a_round_ago(robot.nq());
  double angle = 0.0, off = 0.0;
  for (int cycle = 0; cycle < 3 * round; ++cycle) {
    controller.update(q, v, cycle * dt, v);
    q += dt * v;
    if (cycle >= round) {
      angle = std::max(angle, controller.task(point).error().norm());
      off = std::max(off, std::abs(controller.task(keep).error()[0]));
    }
    if (cycle == 2 * round - 1) {
      a_round_ago = q;
    }
  }

  const double drift = (q - a_round_ago).cwiseAbs().maxCoeff();
  std::printf("from 5 s on: points within %.2f mrad, height within %.3f mm\n", 1e3 * angle, 1e3 * off);
  std::printf("joints after another round: within %.1e\n", drift);
  return angle < 1e-3 && off < 1e-3 && drift < 1e-3 ? 0 : 1;
}
