#pragma once

#include <tope/robot/robot.hpp>

#include <urdf_model/model.h>

#include <string>

namespace tope {

/// Puts the joints of a moving base above the root. Errors: ConfigError, beginning with `where`, when the URDF has a joint
/// or link of one of their names already.
void add_moving_base(const RobotConfig::MovingBase& base, const std::string& where,
                     urdf::ModelInterface& tree);

}  // namespace tope
