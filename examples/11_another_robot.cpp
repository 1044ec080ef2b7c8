// Run: build/Release/examples/example_11_another_robot        Twin: 11_another_robot.py
// A Panda instead of the youBot, from a package's URDF and with no setting changed: on a table, where it meets a joint
// limit on its way to one goal and cannot reach another, and on a base that drives, which can.
#include <tope/controller/controller.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_position.hpp>

#include <algorithm>
#include <cstdio>

namespace {

struct Outcome {
  double left;        // distance from the goal at the end [m]
  double room = 1e3;  // least distance from a limit [rad or m]
};

/// Six seconds, the hand pointing down.
Outcome drive(const char* name, const tope::Robot& robot, const tope::Vector3& goal) {
  const double dt = 1e-3;
  const char* hand = "panda_hand_tcp";
  tope::Controller controller{robot, {.mode = tope::Mode::velocity, .dt = dt}};
  const tope::Matrix3 down = tope::Vector3(1, -1, -1).asDiagonal();
  controller.add(1, tope::FrameOrientation{robot, hand, down});
  const auto reach = controller.add(2, tope::FramePosition{robot, hand, goal});
  tope::Vector q = tope::Vector::Zero(robot.nq());
  q.tail<7>() << 0, -0.4, 0, -2.0, 0, 1.6, 0.8;
  tope::Vector v = tope::Vector::Zero(robot.nv());
  Outcome outcome{};
  for (int cycle = 0; cycle < 6000; ++cycle) {
    controller.update(q, v, cycle * dt, v);
    q += dt * v;
    outcome.room =
        std::min(outcome.room, (robot.position_upper() - q).cwiseMin(q - robot.position_lower()).minCoeff());
  }
  outcome.left = controller.task(reach).error().norm();
  std::printf("%-18s %8.2f mm from the goal, %.4f kept from limits\n", name, 1e3 * outcome.left,
              outcome.room);
  return outcome;
}

}  // namespace

int main() {
  const char* urdf = "package://example-robot-data/robots/panda_description/urdf/panda.urdf";
  auto config = tope::RobotConfig::from_yaml("robots/panda.yaml");
  const auto arm = tope::Robot::from_urdf(urdf, config);
  config.base = {.type = tope::RobotConfig::MovingBase::Type::planar, .speed = 0.8, .turn_rate = 1.5};
  const auto mobile = tope::Robot::from_urdf(urdf, config);  // on joints base_x, base_y and base_yaw

  const tope::Vector3 far(1.6, 0.8, 0.5);
  const Outcome behind = drive("on a table, behind", arm, tope::Vector3(-0.4, 0.2, 0.4));
  const Outcome too_far = drive("on a table, far", arm, far);
  const Outcome driven = drive("on a base, far", mobile, far);
  const bool reached = std::max(behind.left, driven.left) < 1e-3 && too_far.left > 0.5;
  const bool kept = std::min({behind.room, too_far.room, driven.room}) > 0.0;
  return reached && kept && behind.room < 0.01 ? 0 : 1;
}
