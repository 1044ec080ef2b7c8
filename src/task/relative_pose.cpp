#include "../reference/target_checks.hpp"
#include "orientation_rows.hpp"

#include <tope/common/error.hpp>
#include <tope/task/relative_pose.hpp>

#include <Eigen/Geometry>

#include <utility>

namespace tope {
namespace {

int rows_of(const RelativeTarget& target) {
  const int rows =
      3 * (static_cast<int>(target.position.has_value()) + static_cast<int>(target.rotation.has_value()));
  if (rows == 0) {
    throw ConfigError("RelativePose: target: names neither a position nor a rotation");
  }
  return rows;
}

}  // namespace

RelativePose::RelativePose(const Robot& robot, const std::string& frame, const std::string& seen_from,
                           RelativeTarget target, Reference reference)
    : Task(rows_of(target), robot.nv(), std::move(reference)),
      frame_(robot.frame_index(frame)),
      seen_from_(robot.frame_index(seen_from)),
      target_(std::move(target)),
      relative_jacobian_(6, robot.nv()) {
  require_moving(robot);
  if (target_.position) {
    require_finite("RelativePose: position", target_.position->at(0.0).position);
  }
  if (target_.rotation) {
    require_rotation("RelativePose: rotation", target_.rotation->at(0.0).rotation);
  }
}

std::string_view RelativePose::error_unit() const {
  if (target_.position && target_.rotation) {
    return "mixed";
  }
  return target_.position ? "m" : "rad";
}

/// A joint between the two frames turns or shifts one against the other in every state.
void RelativePose::require_moving(const Robot& robot) {
  find_relative_motion(RobotTerms(robot));
  if (relative_jacobian_.isZero(1e-12)) {
    throw ConfigError("RelativePose: no joint moves frame '" + robot.frame_name(frame_) +
                      "' against frame '" + robot.frame_name(seen_from_) + "'");
  }
}

void RelativePose::find_relative_motion(const RobotTerms& terms) {
  const Matrix3 world_to_onlooker = terms.frame_rotation(seen_from_).transpose();
  const Vector3 origin = terms.frame_position(seen_from_);
  relative_jacobian_ = terms.frame_jacobian(seen_from_);  // asking for the other frame overwrites it
  offset_ = terms.frame_position(frame_) - origin;
  position_ = world_to_onlooker * offset_;
  rotation_ = world_to_onlooker * terms.frame_rotation(frame_);
  const auto& frame_jacobian = terms.frame_jacobian(frame_);
  for (Eigen::Index j = 0; j < relative_jacobian_.cols(); ++j) {
    const Eigen::Matrix<double, 6, 1> onlooker = relative_jacobian_.col(j);
    const Vector3 shift =
        frame_jacobian.col(j).head<3>() - onlooker.head<3>() - onlooker.tail<3>().cross(offset_);
    relative_jacobian_.col(j).head<3>() = world_to_onlooker * shift;
    relative_jacobian_.col(j).tail<3>() =
        world_to_onlooker * (frame_jacobian.col(j).tail<3>() - onlooker.tail<3>());
  }
}

void RelativePose::evaluate(const RobotTerms& terms, double t) {
  find_relative_motion(terms);
  if (target_.position) {
    const PointTarget point = target_.position->at(t);
    error_.head<3>() = position_ - point.position;
    jacobian_.topRows<3>() = relative_jacobian_.topRows<3>();
    feedforward_.head<3>() = point.velocity;
  }
  if (target_.rotation) {
    near_flip_ = fill_orientation_rows(rotation_, relative_jacobian_.bottomRows<3>(), target_.rotation->at(t),
                                       error_.tail<3>(), jacobian_.bottomRows<3>(), feedforward_.tail<3>());
  }
}

void RelativePose::evaluate_drift(const RobotTerms& terms, double t) {
  const Matrix3 world_to_onlooker = terms.frame_rotation(seen_from_).transpose();
  const Eigen::Matrix<double, 6, 1> onlooker = terms.frame_jacobian(seen_from_) * terms.velocity();
  const Eigen::Matrix<double, 6, 1> onlooker_drift = terms.frame_drift(seen_from_);
  const Eigen::Matrix<double, 6, 1> velocity = terms.frame_jacobian(frame_) * terms.velocity() - onlooker;
  const Eigen::Matrix<double, 6, 1> drift = terms.frame_drift(frame_) - onlooker_drift;
  const Vector3 turn = onlooker.tail<3>();  // of the axes: d/dt R_A^T x = R_A^T (x' - turn x x)
  if (target_.position) {
    const Vector3 acceleration = drift.head<3>() - onlooker_drift.tail<3>().cross(offset_) -
                                 2.0 * turn.cross(velocity.head<3>()) + turn.cross(turn.cross(offset_));
    drift_.head<3>() = world_to_onlooker * acceleration - target_.position->at(t).acceleration;
  }
  if (target_.rotation) {
    const Vector3 acceleration = drift.tail<3>() - turn.cross(velocity.tail<3>());
    drift_.tail<3>() = orientation_drift({.rotation = rotation_,
                                          .angular_velocity = world_to_onlooker * velocity.tail<3>(),
                                          .angular_acceleration = world_to_onlooker * acceleration},
                                         target_.rotation->at(t), error_.tail<3>(), error_rate_.tail<3>());
  }
}

}  // namespace tope
