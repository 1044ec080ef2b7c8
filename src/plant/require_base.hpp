#pragma once

#include <tope/common/error.hpp>
#include <tope/robot/robot.hpp>

namespace tope {

/// Errors: ConfigError for a robot that has no wheels to drive and to read.
inline const MecanumBase& require_base(const Robot& robot) {
  if (!robot.base()) {
    throw ConfigError("plant: the robot's file has no mecanum_base, whose wheels move the base");
  }
  return *robot.base();
}

}  // namespace tope
