// Run: build/Release/examples/example_13_arm_and_base        Twin: 13_arm_and_base.py
// The base drives round a circle. The gripper keeps its pose as the base sees it. Then it is to reach a point too far for
// the arm: by the arm alone, so that the base keeps to its circle although its level is the lower one, and by the whole
// robot, where the base leaves it.
#include <tope/controller/controller.hpp>
#include <tope/task/frame_pose.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_group.hpp>
#include <tope/task/relative_pose.hpp>
#include <tope/task/selected_rows.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace {

struct Worst {  // errors once the start is forgotten [m, rad]
  double first = 0.0;
  double second = 0.0;
};

/// Six seconds with the second task below the first.
Worst drive(const tope::Robot& robot, const tope::Task& first, const tope::Task& second) {
  const double dt = 1e-3;
  tope::Controller controller{robot, {.mode = tope::Mode::velocity, .dt = dt}};
  const auto above = controller.add(1, first);
  const auto below = controller.add(2, second);
  tope::Vector q(robot.nq());
  q << 0, 0, 0, 0, 0.2, 0.6, 0.6, 0.3;
  tope::Vector v = tope::Vector::Zero(robot.nv());
  Worst worst;
  for (int cycle = 0; cycle < 6000; ++cycle) {
    controller.update(q, v, cycle * dt, v);
    q += dt * v;
    if (cycle >= 2500) {
      worst.first = std::max(worst.first, controller.task(above).error().norm());
      worst.second = std::max(worst.second, controller.task(below).error().norm());
    }
  }
  return worst;
}

}  // namespace

int main() {
  const auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");
  const double radius = 0.5;  // [m]
  const double turn = 0.4;    // [rad/s]
  const std::function<tope::PointTarget(double)> on_circle = [=](double t) {
    const double c = radius * std::cos(turn * t);
    const double s = radius * std::sin(turn * t);
    return tope::PointTarget{.position = {s, radius - c, 0.0}, .velocity = {turn * c, turn * s, 0.0}};
  };
  const auto heading = tope::spinning(tope::Matrix3::Identity(), turn * tope::Vector3::UnitZ());

  const tope::Exponential stiff{5.0};
  const tope::FramePose pose{robot, "base_link", tope::Target<tope::PointTarget>(on_circle), heading, stiff};
  const tope::SelectedRows base{pose, {0, 1, 5}};  // what a base has of a pose: x, y and yaw
  const tope::Matrix3 pitched = Eigen::AngleAxisd(1.9, tope::Vector3::UnitY()).toRotationMatrix();
  const tope::RelativePose carry{robot,
                                 "ee",
                                 "base_link",
                                 {.position = tope::PointTarget{.position = {0.6, 0.0, 0.35}},
                                  .rotation = tope::RotationTarget{pitched}},
                                 stiff};
  const tope::FramePosition reach{robot, "ee", tope::Vector3(1.4, 0.3, 0.3), stiff};
  const tope::JointGroup by_arm{
      robot, reach, {"arm_joint_1", "arm_joint_2", "arm_joint_3", "arm_joint_4", "arm_joint_5"}};

  const Worst carried = drive(robot, base, carry);
  const Worst alone = drive(robot, by_arm, base);
  const Worst whole = drive(robot, reach, base);
  std::printf("carried:     base off by %7.2f mm or mrad, gripper by %7.2f\n", 1e3 * carried.first,
              1e3 * carried.second);
  std::printf("arm alone:   base off by %7.2f mm or mrad, gripper by %7.2f\n", 1e3 * alone.second,
              1e3 * alone.first);
  std::printf("whole robot: base off by %7.2f mm or mrad, gripper by %7.2f\n", 1e3 * whole.second,
              1e3 * whole.first);
  const bool follows = std::max({carried.first, carried.second, alone.second, whole.first}) < 1e-3;
  return follows && alone.first > 0.1 && whole.second > 0.1 ? 0 : 1;
}
