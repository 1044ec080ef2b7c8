#pragma once

#include <tope/reference/target.hpp>
#include <tope/task/task.hpp>

#include <string>

namespace tope {

/// Brings the origin of a frame to a point of the world: e = p(q) - p_d [m], 3 rows, along the world's axes.
class FramePosition final : public Task {
 public:
  /// Errors: ConfigError for an unknown frame or a target that is not finite.
  FramePosition(const Robot& robot, const std::string& frame, const Vector3& target,
                Reference reference = Exponential{});
  FramePosition(const Robot& robot, const std::string& frame, Target<PointTarget> target,
                Reference reference = Exponential{});

  std::string_view type() const override { return "frame_position"; }
  std::string_view error_unit() const override { return "m"; }
  std::unique_ptr<Task> clone() const override { return std::make_unique<FramePosition>(*this); }
  std::optional<FrameGoal> frame_goal(double t) const override;
  std::unique_ptr<Task> aimed_at(const Target<PointTarget>& point,
                                 const Target<RotationTarget>& rotation) const override;

 private:
  void evaluate(const RobotTerms& terms, double t) override;
  void evaluate_drift(const RobotTerms& terms, double t) override;

  int frame_;
  Target<PointTarget> target_;
};

}  // namespace tope
