// Run: build/Release/examples/example_10_distances        Twin: 10_distances.py
// The gripper goes round a post to a goal behind it, then to one close to the base. Told of the post and of its own shape,
// the robot keeps the margin; not told, it would go through both.
#include <tope/controller/controller.hpp>
#include <tope/task/frame_position.hpp>

#include <algorithm>
#include <cstdio>
#include <string>

namespace {

struct Outcome {
  double from_post = 1.0;    // least distance [m]
  double from_itself = 1.0;  // likewise
  double error = 0.0;        // larger of both at the goals [m]
};

Outcome drive(const tope::Robot& robot, const tope::LimitOptions& limits,
              const tope::LimitOptions& measured) {
  const double dt = 1e-3;
  tope::Controller controller{robot, {.dt = dt, .limits = limits}};
  tope::Controller observer{robot, {.dt = dt, .limits = measured}};  // measures; its commands go nowhere
  const tope::CollisionLimits& pairs = *observer.collisions();
  const auto reach = controller.add(1, tope::FramePosition{robot, "ee", tope::Vector3(0.3, -0.45, 0.2)});
  tope::Vector q(robot.nq());
  q << 0, 0, 0, 0, 0.4, 0.9, 0.6, 0;
  tope::Vector v = tope::Vector::Zero(robot.nv());
  tope::Vector unused(robot.nv());
  Outcome outcome;
  for (int cycle = 0; cycle < 8000; ++cycle) {
    if (cycle == 4000) {
      outcome.error = controller.task(reach).error().norm();
      controller.replace(reach, tope::FramePosition{robot, "ee", tope::Vector3(0.1, -0.1, 0.1)},
                         {.over = 0.5});
    }
    observer.update(q, v, cycle * dt, unused);
    controller.update(q, v, cycle * dt, v);
    q += dt * v;
    for (int pair = 0; pair < pairs.size(); ++pair) {
      double& least = pairs.names()[static_cast<std::size_t>(pair)].ends_with(".post") ? outcome.from_post
                                                                                       : outcome.from_itself;
      least = std::min(least, pairs.distance()[pair]);
    }
  }
  outcome.error = std::max(outcome.error, controller.task(reach).error().norm());
  return outcome;
}

}  // namespace

int main() {
  auto robot =
      tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");  // with its spheres
  tope::Vector lower = robot.position_lower();
  tope::Vector upper = robot.position_upper();
  lower.head<3>().setConstant(-0.15);  // little room to drive: the arm has to do it
  upper.head<3>().setConstant(0.15);
  robot.set_position_limits(lower, upper);

  const double margin = 0.02;
  const tope::CollisionBody post{
      .name = "post", .shape = tope::shape::Cylinder{0.05, 1.0}, .position = {0.5, -0.2, 0.5}};
  const tope::LimitOptions keeping{
      .collisions = tope::CollisionOptions{.geometry = {.bodies = {post}}, .margin = margin}};
  const Outcome kept = drive(robot, keeping, keeping);
  const Outcome ignored = drive(robot, {}, keeping);
  std::printf("least distance from the post %.1f mm, not told of it %.1f\n", 1e3 * kept.from_post,
              1e3 * ignored.from_post);
  std::printf("least distance from itself %.1f mm, not told of it %.1f\n", 1e3 * kept.from_itself,
              1e3 * ignored.from_itself);
  std::printf("errors at the goals: at most %.2f mm\n", 1e3 * kept.error);
  const bool clear = std::min(kept.from_post, kept.from_itself) > margin;
  const bool would_touch = std::max(ignored.from_post, ignored.from_itself) < 0.0;
  return kept.error < 1e-3 && clear && would_touch ? 0 : 1;
}
