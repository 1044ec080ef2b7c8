#include "distinct_joints.hpp"

#include <tope/common/error.hpp>

#include <algorithm>

namespace tope {

std::vector<int> distinct_joints(const Robot& robot, const std::vector<std::string>& names,
                                 const std::string& what) {
  std::vector<int> joints;
  for (const std::string& name : names) {
    const int joint = robot.joint_index(name);
    if (std::find(joints.begin(), joints.end(), joint) != joints.end()) {
      throw ConfigError(what + " '" + name + "' is named twice");
    }
    joints.push_back(joint);
  }
  return joints;
}

}  // namespace tope
