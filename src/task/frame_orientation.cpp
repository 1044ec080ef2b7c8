#include "../reference/target_checks.hpp"
#include "orientation_rows.hpp"

#include <tope/task/frame_orientation.hpp>

#include <utility>

namespace tope {

FrameOrientation::FrameOrientation(const Robot& robot, const std::string& frame, const Matrix3& target,
                                   Reference reference)
    : FrameOrientation(robot, frame, Target<RotationTarget>(RotationTarget{.rotation = target}),
                       std::move(reference)) {}

FrameOrientation::FrameOrientation(const Robot& robot, const std::string& frame,
                                   Target<RotationTarget> target, Reference reference)
    : Task(3, robot.nv(), std::move(reference)),
      frame_(robot.frame_index(frame)),
      target_(std::move(target)) {
  require_rotation("FrameOrientation: target", target_.at(0.0).rotation);
}

std::optional<FrameGoal> FrameOrientation::frame_goal(double t) const {
  return FrameGoal{.frame = frame_, .rotation = target_.at(t).rotation};
}

std::unique_ptr<Task> FrameOrientation::aimed_at(const Target<PointTarget>& /*point*/,
                                                 const Target<RotationTarget>& rotation) const {
  auto copy = std::make_unique<FrameOrientation>(*this);
  copy->target_ = rotation;
  return copy;
}

void FrameOrientation::evaluate(const RobotTerms& terms, double t) {
  near_flip_ =
      fill_orientation_rows(terms.frame_rotation(frame_), terms.frame_jacobian(frame_).bottomRows<3>(),
                            target_.at(t), error_, jacobian_, feedforward_);
}

void FrameOrientation::evaluate_drift(const RobotTerms& terms, double t) {
  drift_ =
      orientation_drift({.rotation = terms.frame_rotation(frame_),
                         .angular_velocity = terms.frame_jacobian(frame_).bottomRows<3>() * terms.velocity(),
                         .angular_acceleration = terms.frame_drift(frame_).tail<3>()},
                        target_.at(t), error_, error_rate_);
}

}  // namespace tope
