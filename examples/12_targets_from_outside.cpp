// Run: build/Release/examples/example_12_targets_from_outside        Twin: 12_targets_from_outside.py
// Targets from a planner and from a camera: waypoints, passed at their times, and samples at 50 Hz that stay out for half a
// second. A stream makes no jump of what would be one where samples are taken as they come.
#include <tope/controller/controller.hpp>
#include <tope/reference/target_stream.hpp>
#include <tope/reference/waypoints.hpp>
#include <tope/task/frame_position.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

namespace {

constexpr double dt = 1e-3;      // [s]
constexpr double period = 0.02;  // of the camera [s]
constexpr double rate = 20.0;    // of the stream's follower [1/s]
constexpr double radius = 0.1;   // of the circle on which a thing moves [m]
constexpr double turn = 1.2;     // [rad/s]

tope::Vector3 home() { return {0.6, 0.0, 0.35}; }  // the circle's centre

tope::PointSample thing(double t) {
  const double c = radius * std::cos(turn * t);
  const double s = radius * std::sin(turn * t);
  return {
      .time = t, .position = home() + tope::Vector3(0.0, c, s), .velocity = turn * tope::Vector3(0.0, -s, c)};
}

struct Outcome {
  std::vector<tope::Vector3> places{};  // of the gripper, in each cycle of eight seconds
  double jump =
      0.0;  // largest change of a command in a cycle, once the start is forgotten, share of its bound
};

Outcome follow(
    const tope::Robot& robot, const tope::Target<tope::PointTarget>& target,
    const std::function<void(const tope::PointSample&)>& put = [](const tope::PointSample&) {}) {
  tope::Controller controller{robot, {.mode = tope::Mode::velocity, .dt = dt}};
  const auto reach = controller.add(1, tope::FramePosition{robot, "ee", target, tope::Exponential{20.0}});
  tope::Vector q(robot.nq());
  q << 0, 0, 0, 0, 0.4, 0.9, 0.6, 0;
  tope::Vector v = tope::Vector::Zero(robot.nv());
  Outcome outcome;
  for (int cycle = 0; cycle < 8000; ++cycle) {
    const double t = cycle * dt;
    if (cycle >= 1000 && cycle % std::lround(period / dt) == 0 && (cycle < 4000 || cycle >= 4500)) {
      put(thing(t));  // in the loop to be repeatable; any thread may
    }
    const tope::Vector last = v;
    controller.update(q, v, t, v);
    outcome.places.emplace_back(controller.task(reach).error() + target.at(t).position);
    if (cycle > 500) {
      outcome.jump =
          std::max(outcome.jump, (v - last).cwiseQuotient(robot.velocity_limit()).cwiseAbs().maxCoeff());
    }
    q += dt * v;
  }
  return outcome;
}

}  // namespace

int main() {
  const auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");

  const std::vector<tope::PointWaypoint> waypoints{
      {1.0, home()}, {3.0, {0.7, 0.2, 0.3}}, {5.0, {0.8, 0.0, 0.5}}, {7.0, {0.6, -0.1, 0.2}}};
  const Outcome planned = follow(robot, tope::through(waypoints));
  double missed = 0.0;
  for (const tope::PointWaypoint& waypoint : waypoints) {
    const auto cycle = static_cast<std::size_t>(std::lround(waypoint.time / dt));
    missed = std::max(missed, (planned.places[cycle] - waypoint.position).norm());
  }

  tope::PointStream stream{home(), {.rate = rate}};
  bool taken = true;
  const Outcome streamed = follow(
      robot, stream.target(), [&](const tope::PointSample& sample) { taken = stream.put(sample) && taken; });
  tope::PointTarget latest{.position = home()};  // a sample taken as it comes
  const std::function<tope::PointTarget(double)> step = [&](double) { return latest; };
  const Outcome stepped = follow(robot, tope::Target<tope::PointTarget>(step),
                                 [&](const tope::PointSample& sample) { latest.position = sample.position; });

  double lag = 0.0;
  for (int cycle = 2500; cycle < 8000; ++cycle) {
    if (cycle < 4000 || cycle >= 6000) {
      const tope::Vector3& place = streamed.places[static_cast<std::size_t>(cycle)];
      lag = std::max(lag, (place - thing(cycle * dt).position).norm());
    }
  }
  // a follower of three poles, fed so often
  const double expected = 3.0 * radius * turn * turn / rate * (1.0 / rate + 0.5 * period);
  std::printf("waypoints passed within %.3f mm, largest jump %.2f %%\n", 1e3 * missed, 100.0 * planned.jump);
  std::printf("behind the thing %.2f mm, %.2f expected\n", 1e3 * lag, 1e3 * expected);
  std::printf("largest jump %.2f %% by the stream, %.1f %% without it\n", 100.0 * streamed.jump,
              100.0 * stepped.jump);
  const bool passed = missed < 1e-3 && taken && std::abs(lag - expected) < 0.05 * expected;
  const bool continuous = std::max(planned.jump, streamed.jump) < 0.01 && stepped.jump > 0.2;
  return passed && continuous ? 0 : 1;
}
