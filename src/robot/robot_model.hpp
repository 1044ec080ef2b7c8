#pragma once

#include <pinocchio/multibody.hpp>

namespace tope {

/// The one place that names Pinocchio's model; included by the robot room's sources alone.
struct RobotModel {
  pinocchio::Model model;
};

}  // namespace tope
