#include <tope/reference/target.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace tope {

Target<PointTarget> moving_along_line(const Vector3& start, const Vector3& velocity) {
  return Target<PointTarget>(std::function<PointTarget(double)>([start, velocity](double t) {
    return PointTarget{.position = start + t * velocity, .velocity = velocity};
  }));
}

Target<PointTarget> moving_along_sine(const Vector3& centre, const Vector3& amplitude, double frequency) {
  const double omega = 2.0 * std::numbers::pi * frequency;
  return Target<PointTarget>(std::function<PointTarget(double)>([centre, amplitude, omega](double t) {
    return PointTarget{.position = centre + std::sin(omega * t) * amplitude,
                       .velocity = omega * std::cos(omega * t) * amplitude,
                       .acceleration = -omega * omega * std::sin(omega * t) * amplitude};
  }));
}

Target<RotationTarget> spinning(const Matrix3& start, const Vector3& angular_velocity) {
  const double speed = angular_velocity.norm();
  const Vector3 axis = speed > 0.0 ? Vector3(angular_velocity / speed) : Vector3::UnitZ();
  return Target<RotationTarget>(std::function<RotationTarget(double)>([start, axis, speed](double t) {
    return RotationTarget{.rotation = Eigen::AngleAxisd(speed * t, axis).toRotationMatrix() * start,
                          .angular_velocity = speed * axis};
  }));
}

}  // namespace tope
