// Run: build/Release/examples/example_04_compare_limits        Twin: 04_compare_limits.py
// Three ways to meet the same limits. The largest jump of a command falls tenfold with the period where the command is
// continuous, and stays where it is not.
#include <tope/controller/controller.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_position.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

/// Largest change of a command from one cycle to the next, as a share of the joint's bound, in three seconds in which
/// two joints meet a limit.
double largest_jump(const tope::Robot& robot, tope::LimitMethod method, double dt) {
  tope::Controller controller{robot, {.mode = tope::Mode::velocity, .dt = dt, .limits = {.method = method}}};
  controller.add(
      1, tope::FrameOrientation{robot, "ee",
                                Eigen::Quaterniond(0.0397, 0.9811, 0.1867, -0.0322).normalized().matrix()});
  controller.add(2, tope::FramePosition{robot, "ee", tope::Vector3(0.640, 0.105, 0.068)});
  tope::Vector q(robot.nq());
  q << 0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8;
  tope::Vector v = tope::Vector::Zero(robot.nv());
  double jump = 0.0;
  for (int cycle = 0; cycle < std::lround(3.0 / dt); ++cycle) {
    const tope::Vector last = v;
    controller.update(q, v, cycle * dt, v);
    q += dt * v;
    if (cycle > 0) {
      jump = std::max(jump, (v - last).cwiseQuotient(robot.velocity_limit()).cwiseAbs().maxCoeff());
    }
  }
  return jump;
}

/// How many times smaller the largest jump is at a tenth of the period.
double ratio(const tope::Robot& robot, tope::LimitMethod method) {
  const double coarse = largest_jump(robot, method, 1e-3);
  const double fine = largest_jump(robot, method, 1e-4);
  std::printf("%-10s jump %6.3f %% at 1 ms, %6.3f %% at 0.1 ms, ratio %5.2f\n",
              tope::to_string(method).c_str(), 100.0 * coarse, 100.0 * fine, coarse / fine);
  return coarse / fine;
}

}  // namespace

int main() {
  auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");
  tope::Vector upper = robot.position_upper();
  upper[robot.joint_index("base_x")] = 0.35;  // an obstacle on the floor
  robot.set_position_limits(robot.position_lower(), upper);

  const double unilateral = ratio(robot, tope::LimitMethod::unilateral);
  const double chain = ratio(robot, tope::LimitMethod::chain);
  const double on_or_off = ratio(robot, tope::LimitMethod::switching);
  return std::min(unilateral, chain) > 9.0 && on_or_off < 1.5 ? 0 : 1;
}
