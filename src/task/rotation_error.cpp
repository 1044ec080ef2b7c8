#include <tope/task/rotation_error.hpp>

#include <Eigen/Geometry>

#include <cmath>

namespace tope {

Vector3 rotation_vector(const Matrix3& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0.0) {
    q.coeffs() = -q.coeffs();
  }
  const double sine = q.vec().norm();  // of half the angle
  const double angle = 2.0 * std::atan2(sine, q.w());
  const double scale = sine > 1e-8 ? angle / sine : 2.0;
  return scale * q.vec();
}

Matrix3 inverse_right_jacobian(const Vector3& e) {
  const double angle = e.norm();
  // (1 - (angle/2) cot(angle/2)) / angle^2, by its series where the quotient would cancel
  const double c = angle < 1e-3 ? 1.0 / 12.0 + angle * angle / 720.0
                                : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / (angle * angle);
  Matrix3 skew;
  skew << 0.0, -e.z(), e.y(), e.z(), 0.0, -e.x(), -e.y(), e.x(), 0.0;
  return Matrix3::Identity() + 0.5 * skew + c * skew * skew;
}

}  // namespace tope
