#pragma once

#include <tope/robot/robot.hpp>

#include <string>
#include <vector>

namespace tope {

/// Indices of joints. Errors: ConfigError for an unknown name; beginning with `what`, for one that is named twice.
std::vector<int> distinct_joints(const Robot& robot, const std::vector<std::string>& names,
                                 const std::string& what);

}  // namespace tope
