// Run: build/Release/examples/example_03_change_tasks        Twin: 03_change_tasks.py
// Tasks enter, get another target, change places and leave while the robot moves: over half a second without a jump, at
// once with one.
#include <tope/controller/controller.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_position.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdio>

namespace {

/// Largest change of a command from one cycle to the next, as a share of the joint's bound, in eight seconds in which
/// every change takes `over` seconds.
double largest_jump(const tope::Robot& robot, double over) {
  const double dt = 1e-3;
  tope::Controller controller{robot, {.mode = tope::Mode::velocity, .dt = dt}};
  const tope::FrameOrientation turn{
      robot, "ee", Eigen::Quaterniond(0.0397, 0.9811, 0.1867, -0.0322).normalized().matrix()};
  const tope::FramePosition near{robot, "ee", tope::Vector3(0.6, 0.1, 0.2)};
  const tope::FramePosition far{robot, "ee", tope::Vector3(0.9, 0.1, 0.2)};
  tope::TaskHandle reach;
  tope::TaskHandle turning;

  tope::Vector q(robot.nq());
  q << 0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8;
  tope::Vector v = tope::Vector::Zero(robot.nv());
  double jump = 0.0;
  for (int cycle = 0; cycle < 8000; ++cycle) {
    switch (cycle) {
      case 1000:
        reach = controller.add(2, near, {.over = over});
        break;
      case 2000:
        turning = controller.add(1, turn, {.over = over});  // above what is there
        break;
      case 4000:
        controller.replace(reach, far, {.over = over});
        break;
      case 5000:
        controller.move(turning, 3, {.over = over});
        break;
      case 6000:
        controller.remove(turning, {.over = over});
        break;
      default:
        break;
    }
    const tope::Vector last = v;
    controller.update(q, v, cycle * dt, v);
    q += dt * v;
    jump = std::max(jump, (v - last).cwiseQuotient(robot.velocity_limit()).cwiseAbs().maxCoeff());
  }
  return jump;
}

}  // namespace

int main() {
  const auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");
  const double smooth = largest_jump(robot, 0.5);
  const double abrupt = largest_jump(robot, 0.0);
  std::printf("largest jump: %.2f %% over 0.5 s, %.1f %% at once\n", 100.0 * smooth, 100.0 * abrupt);
  return smooth < 0.02 && abrupt > 0.2 ? 0 : 1;
}
