#include "distinct_joints.hpp"
#include "generic_position.hpp"

#include <tope/common/error.hpp>
#include <tope/task/joint_group.hpp>
#include <tope/task/selected_rows.hpp>

namespace tope {
namespace {

std::vector<int> indices(const Robot& robot, const std::vector<std::string>& names) {
  if (names.empty()) {
    throw ConfigError("JointGroup: names no joint");
  }
  return distinct_joints(robot, names, "JointGroup: joint");
}

std::unique_ptr<Task> served_part(const Task& task, const std::vector<int>& joints) {
  return task.is_motion() ? std::make_unique<SelectedRows>(task, joints) : task.clone();
}

}  // namespace

JointGroup::JointGroup(const Robot& robot, const Task& task, const std::vector<std::string>& joints)
    : WrappedTask(task.is_motion() ? static_cast<int>(joints.size()) : task.size(),
                  served_part(task, indices(robot, joints))),
      joints_(indices(robot, joints)) {
  require_moved_rows(robot);
}

/// A row without a joint could never be served, and would count as lost to a singularity in every cycle.
void JointGroup::require_moved_rows(const Robot& robot) {
  RobotTerms terms(robot);
  terms.update(generic_position(robot), Vector::Zero(robot.nv()));
  evaluate(terms, 0.0);
  for (Eigen::Index row = 0; row < jacobian_.rows(); ++row) {
    if (jacobian_.row(row).isZero(1e-9)) {
      throw ConfigError("JointGroup: no joint of the group moves row " + std::to_string(row) + " of " +
                        std::string(type()) + "; name one that does, or select the other rows");
    }
  }
}

void JointGroup::evaluate(const RobotTerms& terms, double t) {
  evaluate_part(*task_, terms, t);
  error_ = task_->error();
  feedforward_ = feedforward_of(*task_);
  for (const int joint : joints_) {
    jacobian_.col(joint) = task_->jacobian().col(joint);
  }
  near_flip_ = task_->near_flip();
}

void JointGroup::evaluate_drift(const RobotTerms& terms, double t) {
  evaluate_part_drift(*task_, terms, t);
  error_rate_ = task_->error_rate();
  drift_ = task_->drift();
}

}  // namespace tope
