#pragma once

#include <tope/task/task.hpp>

#include <string>
#include <utility>
#include <vector>

namespace tope {

/// Brings some joints to given positions: e = q_j - target_j [rad or m], one row a joint.
class JointPosition final : public Task {
 public:
  /// Errors: ConfigError for an unknown or repeated joint, no joint, or a target that is not finite.
  JointPosition(const Robot& robot, const std::vector<std::pair<std::string, double>>& targets,
                Reference reference = Exponential{});

  std::string_view type() const override { return "joint_position"; }
  std::string_view error_unit() const override { return unit_; }
  std::unique_ptr<Task> clone() const override { return std::make_unique<JointPosition>(*this); }

 private:
  void evaluate(const RobotTerms& terms, double t) override;

  std::vector<int> joints_;
  Vector target_;
  std::string unit_;
};

}  // namespace tope
