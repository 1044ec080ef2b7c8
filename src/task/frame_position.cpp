#include "../reference/target_checks.hpp"

#include <tope/task/frame_position.hpp>

#include <utility>

namespace tope {

FramePosition::FramePosition(const Robot& robot, const std::string& frame, const Vector3& target,
                             Reference reference)
    : FramePosition(robot, frame, Target<PointTarget>(PointTarget{.position = target}),
                    std::move(reference)) {}

FramePosition::FramePosition(const Robot& robot, const std::string& frame, Target<PointTarget> target,
                             Reference reference)
    : Task(3, robot.nv(), std::move(reference)),
      frame_(robot.frame_index(frame)),
      target_(std::move(target)) {
  require_finite("FramePosition: target", target_.at(0.0).position);
}

std::optional<FrameGoal> FramePosition::frame_goal(double t) const {
  return FrameGoal{.frame = frame_, .position = target_.at(t).position};
}

std::unique_ptr<Task> FramePosition::aimed_at(const Target<PointTarget>& point,
                                              const Target<RotationTarget>& /*rotation*/) const {
  auto copy = std::make_unique<FramePosition>(*this);
  copy->target_ = point;
  return copy;
}

void FramePosition::evaluate(const RobotTerms& terms, double t) {
  const PointTarget target = target_.at(t);
  error_ = terms.frame_position(frame_) - target.position;
  jacobian_ = terms.frame_jacobian(frame_).topRows<3>();
  feedforward_ = target.velocity;
}

void FramePosition::evaluate_drift(const RobotTerms& terms, double t) {
  drift_ = terms.frame_drift(frame_).head<3>() - target_.at(t).acceleration;
}

}  // namespace tope
