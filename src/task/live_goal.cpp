#include <tope/task/live_goal.hpp>
#include <tope/task/rotation_error.hpp>

#include <Eigen/Geometry>

namespace tope {
namespace {

constexpr double kRate = 8.0;  // of the spring [1/s]: there within a few millimetres after about a second

/// Acceleration of a critically damped spring.
Vector3 pull(const Vector3& ahead, const Vector3& velocity) {
  return kRate * kRate * ahead - 2.0 * kRate * velocity;
}

Matrix3 turn(const Vector3& rotation_vector) {
  const double angle = rotation_vector.norm();
  const Vector3 axis = angle > 0.0 ? Vector3(rotation_vector / angle) : Vector3::UnitX();
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

}  // namespace

LiveGoal::LiveGoal(const Vector3& position, const Matrix3& rotation)
    : put_position_(position),
      put_rotation_(rotation),
      point_{.position = position},
      rotation_{.rotation = rotation} {}

void LiveGoal::put(const Vector3& position, const Matrix3& rotation) {
  put_position_ = position;
  put_rotation_ = rotation;
}

void LiveGoal::advance(double dt) {
  point_.acceleration = pull(put_position_ - point_.position, point_.velocity);
  point_.velocity += point_.acceleration * dt;
  point_.position += point_.velocity * dt;

  const Vector3 ahead = rotation_vector(put_rotation_ * rotation_.rotation.transpose());
  rotation_.angular_acceleration = pull(ahead, rotation_.angular_velocity);
  rotation_.angular_velocity += rotation_.angular_acceleration * dt;
  const Matrix3 turned = turn(rotation_.angular_velocity * dt) * rotation_.rotation;
  rotation_.rotation =
      Eigen::Quaterniond(turned).normalized().toRotationMatrix();  // stays a rotation for ever
}

}  // namespace tope
