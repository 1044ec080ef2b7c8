#include "../reference/target_checks.hpp"
#include "orientation_rows.hpp"

#include <tope/task/frame_pose.hpp>

#include <utility>

namespace tope {

FramePose::FramePose(const Robot& robot, const std::string& frame, const Vector3& position,
                     const Matrix3& rotation, Reference reference)
    : FramePose(robot, frame, Target<PointTarget>(PointTarget{.position = position}),
                Target<RotationTarget>(RotationTarget{.rotation = rotation}), std::move(reference)) {}

FramePose::FramePose(const Robot& robot, const std::string& frame, Target<PointTarget> position,
                     Target<RotationTarget> rotation, Reference reference)
    : Task(6, robot.nv(), std::move(reference)),
      frame_(robot.frame_index(frame)),
      position_(std::move(position)),
      rotation_(std::move(rotation)) {
  require_finite("FramePose: position", position_.at(0.0).position);
  require_rotation("FramePose: rotation", rotation_.at(0.0).rotation);
}

std::optional<FrameGoal> FramePose::frame_goal(double t) const {
  return FrameGoal{
      .frame = frame_, .position = position_.at(t).position, .rotation = rotation_.at(t).rotation};
}

std::unique_ptr<Task> FramePose::aimed_at(const Target<PointTarget>& point,
                                          const Target<RotationTarget>& rotation) const {
  auto copy = std::make_unique<FramePose>(*this);
  copy->position_ = point;
  copy->rotation_ = rotation;
  return copy;
}

void FramePose::evaluate(const RobotTerms& terms, double t) {
  const PointTarget point = position_.at(t);
  error_.head<3>() = terms.frame_position(frame_) - point.position;
  jacobian_.topRows<3>() = terms.frame_jacobian(frame_).topRows<3>();
  feedforward_.head<3>() = point.velocity;
  near_flip_ = fill_orientation_rows(terms.frame_rotation(frame_),
                                     terms.frame_jacobian(frame_).bottomRows<3>(), rotation_.at(t),
                                     error_.tail<3>(), jacobian_.bottomRows<3>(), feedforward_.tail<3>());
}

void FramePose::evaluate_drift(const RobotTerms& terms, double t) {
  const Eigen::Matrix<double, 6, 1> frame_drift = terms.frame_drift(frame_);
  drift_.head<3>() = frame_drift.head<3>() - position_.at(t).acceleration;
  drift_.tail<3>() =
      orientation_drift({.rotation = terms.frame_rotation(frame_),
                         .angular_velocity = terms.frame_jacobian(frame_).bottomRows<3>() * terms.velocity(),
                         .angular_acceleration = frame_drift.tail<3>()},
                        rotation_.at(t), error_.tail<3>(), error_rate_.tail<3>());
}

}  // namespace tope
