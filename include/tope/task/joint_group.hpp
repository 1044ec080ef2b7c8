#pragma once

#include <tope/task/wrapped_task.hpp>

#include <memory>
#include <string>
#include <vector>

namespace tope {

/// Another task served by some joints alone: the same error, with the columns of the other joints left out of J. Of a task
/// whose rows are the joints themselves (posture, damping) it keeps the rows of the group.
///
/// What the other joints do for other tasks is a disturbance here, which no priority keeps away: J v then lacks their
/// part d = J_others v_others of the error's rate.
/// - In velocity mode the task puts no speed on them. Feedback alone answers d: under an exponential reference, one that
///   lasts leaves an error of d / gain. Accelerations of theirs of the same kind are all that disturbs torque mode, where
///   error rate and drift are those of the whole robot: they leave J_others dv_others/dt / gain^2.
/// - In torque mode the task puts no torque on them, u - h = J_group^T f, and the mass matrix carries them along like any
///   joint that nothing holds. The group's rows leave them all their freedom, so a lower level that asks them to rest
///   (posture, damping) holds them against that, and the task loses nothing by it.
/// Lower levels cannot disturb it through the group's own joints.
class JointGroup final : public WrappedTask {
 public:
  /// Errors: ConfigError for an unknown or repeated joint, no joint, or a row that no joint of the group moves.
  JointGroup(const Robot& robot, const Task& task, const std::vector<std::string>& joints);

  std::unique_ptr<Task> clone() const override { return std::make_unique<JointGroup>(*this); }

 private:
  void evaluate(const RobotTerms& terms, double t) override;
  void evaluate_drift(const RobotTerms& terms, double t) override;
  void require_moved_rows(const Robot& robot);

  std::vector<int> joints_;
};

}  // namespace tope
