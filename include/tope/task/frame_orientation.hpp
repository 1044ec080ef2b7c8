#pragma once

#include <tope/reference/target.hpp>
#include <tope/task/task.hpp>

#include <string>

namespace tope {

/// Turns a frame as a target is turned: e = log(R_d^T R) [rad], 3 rows, the rotation vector from the target
/// to the frame along the target's axes. Its direction flips where the angle reaches pi; near_flip() warns.
class FrameOrientation final : public Task {
 public:
  /// Errors: ConfigError for an unknown frame or a target that is not a rotation matrix.
  FrameOrientation(const Robot& robot, const std::string& frame, const Matrix3& target,
                   Reference reference = Exponential{});
  FrameOrientation(const Robot& robot, const std::string& frame, Target<RotationTarget> target,
                   Reference reference = Exponential{});

  std::string_view type() const override { return "frame_orientation"; }
  std::string_view error_unit() const override { return "rad"; }
  std::unique_ptr<Task> clone() const override { return std::make_unique<FrameOrientation>(*this); }
  std::optional<FrameGoal> frame_goal(double t) const override;
  std::unique_ptr<Task> aimed_at(const Target<PointTarget>& point,
                                 const Target<RotationTarget>& rotation) const override;

 private:
  void evaluate(const RobotTerms& terms, double t) override;
  void evaluate_drift(const RobotTerms& terms, double t) override;

  int frame_;
  Target<RotationTarget> target_;
};

}  // namespace tope
