#include "mimic_joints.hpp"

#include <tope/common/error.hpp>

namespace tope {
namespace {

/// Holds the joints that mimic one held so far; true when there was one.
bool hold_next(urdf::ModelInterface& tree, std::map<std::string, double>& locked) {
  bool found = false;
  for (auto& [name, joint] : tree.joints_) {
    if (!joint->mimic) {
      continue;
    }
    if (joint->type == urdf::Joint::FIXED) {
      joint->mimic.reset();  // it cannot follow
      continue;
    }
    const auto leader = locked.find(joint->mimic->joint_name);
    if (leader != locked.end()) {
      locked.emplace(name, joint->mimic->multiplier * leader->second + joint->mimic->offset);
    }
    if (locked.contains(name)) {
      joint->mimic.reset();
      found = true;
    }
  }
  return found;
}

}  // namespace

void hold_mimic_joints(const std::string& where, urdf::ModelInterface& tree,
                       std::map<std::string, double>& locked) {
  while (hold_next(tree, locked)) {
  }
  for (const auto& [name, joint] : tree.joints_) {
    if (joint->mimic) {
      throw ConfigError(where + ": joint '" + name + "' mimics '" + joint->mimic->joint_name +
                        "', which moves: not supported; put '" + joint->mimic->joint_name +
                        "' into locked_joints in the robot's YAML file, which holds both, or '" + name +
                        "' alone");
    }
  }
}

}  // namespace tope
