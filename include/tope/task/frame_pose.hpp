#pragma once

#include <tope/reference/target.hpp>
#include <tope/task/task.hpp>

#include <string>

namespace tope {

/// Position and orientation of a frame as one task of 6 rows: position error [m] over orientation error
/// [rad], as in FramePosition and FrameOrientation.
class FramePose final : public Task {
 public:
  /// Errors: ConfigError for an unknown frame, a position that is not finite, or a matrix that is not a
  /// rotation.
  FramePose(const Robot& robot, const std::string& frame, const Vector3& position, const Matrix3& rotation,
            Reference reference = Exponential{});
  FramePose(const Robot& robot, const std::string& frame, Target<PointTarget> position,
            Target<RotationTarget> rotation, Reference reference = Exponential{});

  std::string_view type() const override { return "frame_pose"; }
  std::string_view error_unit() const override { return "mixed"; }
  std::unique_ptr<Task> clone() const override { return std::make_unique<FramePose>(*this); }
  std::optional<FrameGoal> frame_goal(double t) const override;
  std::unique_ptr<Task> aimed_at(const Target<PointTarget>& point,
                                 const Target<RotationTarget>& rotation) const override;

 private:
  void evaluate(const RobotTerms& terms, double t) override;
  void evaluate_drift(const RobotTerms& terms, double t) override;

  int frame_;
  Target<PointTarget> position_;
  Target<RotationTarget> rotation_;
};

}  // namespace tope
