#include <tope/task/rotation_error.hpp>

#include <Eigen/Geometry>

#include <cmath>

namespace tope {
namespace {

constexpr double kSmallAngle = 1e-2;  // below it, series: the closed forms cancel

Matrix3 skew_matrix(const Vector3& e) {
  Matrix3 skew;
  skew << 0.0, -e.z(), e.y(), e.z(), 0.0, -e.x(), -e.y(), e.x(), 0.0;
  return skew;
}

/// c = (1 - (angle/2) cot(angle/2)) / angle^2, from angle and tangent of its half.
double quadratic_coefficient(double angle, double half_tangent) {
  const double squared = angle * angle;
  return angle < kSmallAngle ? 1.0 / 12.0 + squared / 720.0 + squared * squared / 30240.0
                             : (1.0 - 0.5 * angle / half_tangent) / squared;
}

/// I + [e] / 2 + c [e]^2, where [e]^2 = e e^T - |e|^2 I.
Matrix3 inverse_right_jacobian(const Vector3& e, double c) {
  Matrix3 result = 0.5 * skew_matrix(e) + c * e * e.transpose();
  result.diagonal().array() += 1.0 - c * e.squaredNorm();
  return result;
}

/// (dc/d angle) / angle.
double quadratic_coefficient_slope(double angle) {
  const double squared = angle * angle;
  if (angle < kSmallAngle) {
    return 1.0 / 360.0 + squared / 7560.0;
  }
  const double sine = std::sin(0.5 * angle);
  const double product = 0.5 * angle / std::tan(0.5 * angle);
  const double product_slope = 0.5 / std::tan(0.5 * angle) - 0.25 * angle / (sine * sine);
  return -(product_slope / squared + 2.0 * (1.0 - product) / (squared * angle)) / angle;
}

}  // namespace

RotationError rotation_error(const Matrix3& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0.0) {
    q.coeffs() = -q.coeffs();
  }
  const double sine = q.vec().norm();  // of half the angle
  const double angle = 2.0 * std::atan2(sine, q.w());
  const Vector3 e = (sine > 1e-8 ? angle / sine : 2.0) * q.vec();
  return {.vector = e,
          .angle = angle,
          .inverse_right_jacobian = inverse_right_jacobian(e, quadratic_coefficient(angle, sine / q.w()))};
}

Vector3 rotation_vector(const Matrix3& rotation) { return rotation_error(rotation).vector; }

Matrix3 inverse_right_jacobian(const Vector3& e) {
  const double angle = e.norm();
  return inverse_right_jacobian(e, quadratic_coefficient(angle, std::tan(0.5 * angle)));
}

Matrix3 inverse_right_jacobian_rate(const Vector3& e, const Vector3& e_rate) {
  const double angle = e.norm();
  const Matrix3 skew = skew_matrix(e);
  const Matrix3 skew_rate = skew_matrix(e_rate);
  const double c = quadratic_coefficient(angle, std::tan(0.5 * angle));
  const double c_rate = quadratic_coefficient_slope(angle) * e.dot(e_rate);
  return 0.5 * skew_rate + c_rate * skew * skew + c * (skew_rate * skew + skew * skew_rate);
}

}  // namespace tope
