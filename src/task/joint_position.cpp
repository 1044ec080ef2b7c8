#include "../reference/target_checks.hpp"

#include <tope/common/error.hpp>
#include <tope/task/joint_position.hpp>

#include <algorithm>

namespace tope {

JointPosition::JointPosition(const Robot& robot, const std::vector<std::pair<std::string, double>>& targets,
                             Reference reference)
    : Task(static_cast<int>(targets.size()), robot.nv(), std::move(reference)),
      target_(static_cast<Eigen::Index>(targets.size())) {
  if (targets.empty()) {
    throw ConfigError("JointPosition: names no joint");
  }
  for (const auto& [name, position] : targets) {
    const int joint = robot.joint_index(name);
    if (std::find(joints_.begin(), joints_.end(), joint) != joints_.end()) {
      throw ConfigError("JointPosition: joint '" + name + "' is named twice");
    }
    const auto row = static_cast<Eigen::Index>(joints_.size());
    joints_.push_back(joint);
    target_[row] = position;
    jacobian_(row, joint) = 1.0;
    unit_ = (unit_.empty() || unit_ == robot.joint_unit(joint)) ? robot.joint_unit(joint) : "mixed";
  }
  require_finite("JointPosition: target", target_);
}

void JointPosition::evaluate(const RobotTerms& terms, double /*t*/) {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    error_[row] = terms.position()[joints_[i]] - target_[row];
  }
}

}  // namespace tope
