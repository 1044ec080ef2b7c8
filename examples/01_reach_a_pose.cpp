// Run: build/Release/examples/example_01_reach_a_pose        Twin: 01_reach_a_pose.py
// The youBot turns and brings its gripper to a pose, and stops short of an obstacle and of a joint limit on
// the way.
#include <tope/controller/controller.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_position.hpp>

#include <Eigen/Geometry>

#include <cstdio>

int main() {
  auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");
  tope::Vector upper = robot.position_upper();
  upper[robot.joint_index("base_x")] = 0.35;  // an obstacle on the floor
  robot.set_position_limits(robot.position_lower(), upper);

  const double dt = 1e-3;
  tope::Controller controller{robot, {.mode = tope::Mode::velocity, .dt = dt}};
  const tope::Matrix3 goal_rotation =
      Eigen::Quaterniond(0.0397, 0.9811, 0.1867, -0.0322).normalized().matrix();
  const tope::Vector3 goal_position(0.640, 0.105, 0.068);
  const auto turn =
      controller.add(1, tope::FrameOrientation{robot, "ee", goal_rotation, tope::Exponential{2.0}});
  const auto reach =
      controller.add(2, tope::FramePosition{robot, "ee", goal_position, tope::Exponential{2.0}});

  tope::Vector q(robot.nq());
  q << 0.15, 0, 0, 0, 0.4, 0.9, 0.6, 1.8;
  tope::Vector v = tope::Vector::Zero(robot.nv());
  for (int cycle = 0; cycle < 8000; ++cycle) {
    controller.update(q, v, cycle * dt, v);  // v: what was commanded last, then what is commanded next
    q += dt * v;                             // a robot that follows its velocity commands
  }

  const double turn_error = controller.task(turn).error().norm();
  const double reach_error = controller.task(reach).error().norm();
  const double room = (upper - q).cwiseMin(q - robot.position_lower()).minCoeff();
  std::printf("orientation error %.2e rad, position error %.2e m, distance kept from limits %.4f\n",
              turn_error, reach_error, room);
  return turn_error < 1e-3 && reach_error < 1e-3 && room > 0.0 ? 0 : 1;
}
