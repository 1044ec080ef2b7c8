// Run: build/Release/examples/example_02_torque_mode        Twin: 02_torque_mode.py
// Torques bring a rigid-body youBot to a pose in five seconds, short of an obstacle and of a joint limit.
#include <tope/controller/controller.hpp>
#include <tope/plant/rigid_body.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_position.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdio>

int main() {
  auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");
  tope::Vector upper = robot.position_upper();
  upper[robot.joint_index("base_x")] = 0.35;  // an obstacle on the floor
  robot.set_position_limits(robot.position_lower(), upper);

  const double dt = 1e-3;
  tope::Controller controller{robot, {.mode = tope::Mode::torque, .dt = dt}};
  const tope::PredefinedTime in_time{{.duration = 5.0, .gain = 15.0}};
  const tope::Matrix3 goal_rotation =
      Eigen::Quaterniond(0.0397, 0.9811, 0.1867, -0.0322).normalized().matrix();
  const auto turn = controller.add(2, tope::FrameOrientation{robot, "ee", goal_rotation, in_time});
  const auto reach =
      controller.add(3, tope::FramePosition{robot, "ee", tope::Vector3(0.620, 0.105, 0.068), in_time});
  controller.add(4, tope::Damping{robot});  // takes the freedom that is left, which would drift

  tope::RigidBody plant{robot, {}, dt};
  tope::Vector q(robot.nq());
  q << 0.13, 0, 0, 0, 0.4, 0.9, 0.6, 1.8;
  plant.reset(q);
  tope::Vector torque(robot.nv());
  tope::Vector last(robot.nv());
  double turn_error = 0.0, reach_error = 0.0, room = 1.0, jump = 0.0;
  for (int cycle = 0; cycle < 8000; ++cycle) {
    controller.update(plant.position(), plant.velocity(), cycle * dt, torque);
    if (cycle > 0) {
      jump = std::max(jump, (torque - last).cwiseQuotient(robot.effort_limit()).cwiseAbs().maxCoeff());
    }
    if (cycle == 5000) {
      turn_error = controller.task(turn).error().norm();
      reach_error = controller.task(reach).error().norm();
    }
    last = torque;
    plant.step(torque, dt);
    const tope::Vector& now = plant.position();
    room = std::min(room, (upper - now).cwiseMin(now - robot.position_lower()).minCoeff());
  }

  const double speed = plant.velocity().cwiseAbs().maxCoeff();
  std::printf("at 5 s: orientation error %.2e rad, position error %.2e m; fastest joint at the end %.1e\n",
              turn_error, reach_error, speed);
  std::printf("distance kept from limits %.4f, largest jump of a torque %.2f %% of its bound\n", room,
              100.0 * jump);
  return turn_error < 1e-3 && reach_error < 1e-3 && room > 0.0 && jump < 0.03 && speed < 1e-3 ? 0 : 1;
}
