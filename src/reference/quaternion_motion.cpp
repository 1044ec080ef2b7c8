#include "quaternion_motion.hpp"

#include <Eigen/Geometry>

namespace tope {
namespace {

/// Vector part of a times the conjugate of b.
Vector3 vector_of_quotient(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
  const Vector3 a_vector = a.tail<3>();
  const Vector3 b_vector = b.tail<3>();
  return b[0] * a_vector - a[0] * b_vector - a_vector.cross(b_vector);
}

}  // namespace

Eigen::Vector4d quaternion_near(const Matrix3& rotation, const Eigen::Vector4d& near) {
  const Eigen::Quaterniond q(rotation);
  const Eigen::Vector4d wxyz(q.w(), q.x(), q.y(), q.z());
  return wxyz.dot(near) < 0.0 ? Eigen::Vector4d(-wxyz) : wxyz;
}

RotationTarget rotation_on(const PathMotion<4>& motion) {
  // q' = w q / 2 for the unit quaternion q = p / |p|, so w = 2 vec(p' p*) / |p|^2: the change of length is real
  const Eigen::Vector4d& p = motion.value;
  const double squared = p.squaredNorm();
  const Vector3 angular_velocity = 2.0 / squared * vector_of_quotient(motion.rate, p);
  const Vector3 angular_acceleration =
      2.0 / squared * (vector_of_quotient(motion.acceleration, p) - p.dot(motion.rate) * angular_velocity);
  return {.rotation = Eigen::Quaterniond(p[0], p[1], p[2], p[3]).normalized().toRotationMatrix(),
          .angular_velocity = angular_velocity,
          .angular_acceleration = angular_acceleration};
}

}  // namespace tope
