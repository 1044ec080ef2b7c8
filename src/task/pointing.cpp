#include "../reference/target_checks.hpp"
#include "near_flip.hpp"

#include <tope/common/error.hpp>
#include <tope/task/pointing.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace tope {
namespace {

constexpr double kFlip = 0.01;  // of pi [rad]: a direction nearer to it is taken to be this far off
constexpr double kSmallestDistance = 1e-3;  // [m]

using Matrix23 = Eigen::Matrix<double, 2, 3>;

Vector3 unit_axis(const Vector3& axis) {
  require_finite("Pointing: axis", axis);
  if (axis.norm() < 1e-9) {
    throw ConfigError("Pointing: axis: has no direction; it must not be zero");
  }
  return axis.normalized();
}

/// Rows of B (d x a) as a matrix times d, with B of two unit vectors b_1 and b_2 = a x b_1.
Matrix23 rows_across(const Vector3& axis) {
  const Vector3 first = axis.unitOrthogonal();
  Matrix23 rows;
  rows << axis.cross(first).transpose(), -first.transpose();
  return rows;
}

/// f(c) = angle / sin(angle) where c = cos(angle), and its derivatives by c.
struct AngleRatio {
  double value = 1.0;
  double slope = 0.0;
  double curvature = 0.0;
};

AngleRatio angle_ratio(double c) {
  AngleRatio f;
  const double x = 1.0 - c;
  if (x < 0.1) {  // where the differences below cancel: f = 1 + x 1/3 (1 + x 2/5 (1 + x 3/7 (...)))
    for (int k = 12; k > 0; --k) {
      const double factor = k / (2.0 * k + 1.0);
      f.curvature = factor * (x * f.curvature - 2.0 * f.slope);
      f.slope = factor * (x * f.slope - f.value);
      f.value = 1.0 + factor * x * f.value;
    }
    return f;
  }
  const double sine_squared = 1.0 - c * c;
  f.value = std::acos(c) / std::sqrt(sine_squared);
  f.slope = (c * f.value - 1.0) / sine_squared;
  f.curvature = (f.value + 3.0 * c * f.slope) / sine_squared;
  return f;
}

/// The direction to a point along the frame's axes, kept away from where the error flips.
struct Sight {
  Sight(const Matrix3& rotation, const Vector3& origin, const Vector3& point, const Vector3& axis)
      : frame_to_point(rotation.transpose() * (point - origin)),
        distance(std::max(frame_to_point.norm(), kSmallestDistance)),
        direction(frame_to_point.norm() > 0.0 ? frame_to_point.normalized() : axis) {
    near_flip = axis.dot(direction) < -std::cos(kNearFlip);
    if (axis.dot(direction) < -std::cos(kFlip)) {
      Vector3 across = direction - axis.dot(direction) * axis;
      across = across.norm() > 1e-9 ? across.normalized() : axis.unitOrthogonal();
      direction = -std::cos(kFlip) * axis + std::sin(kFlip) * across;
    }
  }

  /// Part of a motion of the point that turns the direction.
  Vector3 turning(const Vector3& motion) const {
    return (motion - direction * direction.dot(motion)) / distance;
  }

  Vector3 frame_to_point;
  double distance;
  Vector3 direction;
  bool near_flip = false;
};

}  // namespace

Pointing::Pointing(const Robot& robot, const std::string& frame, const Vector3& axis, const Vector3& target,
                   Reference reference)
    : Pointing(robot, frame, axis, Target<PointTarget>(PointTarget{.position = target}),
               std::move(reference)) {}

Pointing::Pointing(const Robot& robot, const std::string& frame, const Vector3& axis,
                   Target<PointTarget> target, Reference reference)
    : Task(2, robot.nv(), std::move(reference)),
      frame_(robot.frame_index(frame)),
      axis_(unit_axis(axis)),
      across_(rows_across(axis_)),
      target_(std::move(target)) {
  require_finite("Pointing: target", target_.at(0.0).position);
}

void Pointing::evaluate(const RobotTerms& terms, double t) {
  const PointTarget target = target_.at(t);
  const Matrix3 world_to_frame = terms.frame_rotation(frame_).transpose();
  const Sight sight(terms.frame_rotation(frame_), terms.frame_position(frame_), target.position, axis_);
  const AngleRatio ratio = angle_ratio(axis_.dot(sight.direction));
  error_ = ratio.value * across_ * sight.direction;
  const Matrix23 error_by_direction =
      ratio.value * across_ + ratio.slope * (across_ * sight.direction) * axis_.transpose();
  const auto& frame_jacobian = terms.frame_jacobian(frame_);
  for (Eigen::Index j = 0; j < jacobian_.cols(); ++j) {
    const Vector3 origin = world_to_frame * frame_jacobian.col(j).head<3>();
    const Vector3 turn = world_to_frame * frame_jacobian.col(j).tail<3>();
    jacobian_.col(j) = error_by_direction * sight.turning(-origin - turn.cross(sight.frame_to_point));
  }
  feedforward_ = -error_by_direction * sight.turning(world_to_frame * target.velocity);
  near_flip_ = sight.near_flip;
}

void Pointing::evaluate_drift(const RobotTerms& terms, double t) {
  const PointTarget target = target_.at(t);
  const Matrix3 world_to_frame = terms.frame_rotation(frame_).transpose();
  const Sight sight(terms.frame_rotation(frame_), terms.frame_position(frame_), target.position, axis_);
  const Eigen::Matrix<double, 6, 1> velocity = terms.frame_jacobian(frame_) * terms.velocity();
  const Eigen::Matrix<double, 6, 1> drift = terms.frame_drift(frame_);

  // motion of the point as the turning frame sees it
  const Vector3 turn = world_to_frame * velocity.tail<3>();
  const Vector3 approach = world_to_frame * (target.velocity - velocity.head<3>());
  const Vector3 rate = approach - turn.cross(sight.frame_to_point);
  const Vector3 acceleration = world_to_frame * (target.acceleration - drift.head<3>()) -
                               (world_to_frame * drift.tail<3>()).cross(sight.frame_to_point) -
                               turn.cross(approach + rate);
  // direction = frame_to_point / distance, differentiated twice
  const Vector3 direction_rate = sight.turning(rate);
  const Vector3 direction_acceleration = sight.turning(acceleration) -
                                         2.0 * sight.direction.dot(rate) / sight.distance * direction_rate -
                                         direction_rate.squaredNorm() * sight.direction;
  // and then error = f(c) across d with c = a . d
  const AngleRatio ratio = angle_ratio(axis_.dot(sight.direction));
  const double cosine_rate = axis_.dot(direction_rate);
  drift_ = across_ *
           (ratio.value * direction_acceleration + 2.0 * ratio.slope * cosine_rate * direction_rate +
            (ratio.slope * axis_.dot(direction_acceleration) + ratio.curvature * cosine_rate * cosine_rate) *
                sight.direction);
}

}  // namespace tope
