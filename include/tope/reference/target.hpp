#pragma once

#include <tope/common/types.hpp>

#include <functional>

namespace tope {

/// Where a point is to be at one moment.
struct PointTarget {
  Vector3 position;                        ///< [m]
  Vector3 velocity = Vector3::Zero();      ///< [m/s]
  Vector3 acceleration = Vector3::Zero();  ///< [m/s2]
};

/// How a frame is to be turned at one moment.
struct RotationTarget {
  Matrix3 rotation;                                ///< world_R_target
  Vector3 angular_velocity = Vector3::Zero();      ///< along the axes of the world [rad/s]
  Vector3 angular_acceleration = Vector3::Zero();  ///< likewise [rad/s2]
};

/// A target that stands still or moves with time t [s]. A function must neither allocate nor throw: it is
/// called in the control loop.
template <typename Sample>
class Target {
 public:
  Target(const Sample& fixed)
      : fixed_(fixed) {}  // NOLINT(google-explicit-constructor): a fixed target reads as its value
  explicit Target(std::function<Sample(double t)> motion) : fixed_(motion(0.0)), motion_(std::move(motion)) {}

  Sample at(double t) const { return motion_ ? motion_(t) : fixed_; }

 private:
  Sample fixed_;
  std::function<Sample(double)> motion_;
};

/// A point that starts at `start` and moves with constant velocity.
Target<PointTarget> moving_along_line(const Vector3& start, const Vector3& velocity);

/// A point that swings about `centre` with `amplitude` [m] (by axis) and `frequency` [Hz], and starts at the
/// centre.
Target<PointTarget> moving_along_sine(const Vector3& centre, const Vector3& amplitude, double frequency);

/// A frame that starts as `start` and turns with constant angular velocity (world axes) [rad/s].
Target<RotationTarget> spinning(const Matrix3& start, const Vector3& angular_velocity);

}  // namespace tope
