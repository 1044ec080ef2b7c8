#pragma once

#include <tope/reference/target.hpp>

#include <memory>

namespace tope {

/// Where a point was at one moment, and how it moved.
struct PointSample {
  double time = 0.0;                   ///< on the clock of Controller::update [s]
  Vector3 position = Vector3::Zero();  ///< [m]
  Vector3 velocity = Vector3::Zero();  ///< [m/s]
};

/// How a frame was turned at one moment, and how it turned.
struct RotationSample {
  double time = 0.0;                           ///< on the clock of Controller::update [s]
  Matrix3 rotation = Matrix3::Identity();      ///< world_R_target
  Vector3 angular_velocity = Vector3::Zero();  ///< along the axes of the world [rad/s]
};

/// How a target follows its samples.
struct StreamOptions {
  double rate = 20.0;  ///< of the follower, a triple pole [1/s]
  double hold = 0.1;   ///< how long a sample's velocity goes on after its time [s]; then the target stops
};

/// A target that comes in samples from outside, from a camera or a planner in another thread, at times of its own.
///
/// One thread puts samples, any number of targets made by target() read them, in other threads too: a sequence lock over
/// plain numbers. put() is wait-free. A read tries a few times, and where every try meets a put() keeps the sample it has
/// until the next cycle; it never waits, allocates or throws.
///
/// Between samples, and for `hold` after the last, the goal g goes on with the sample's velocity; then it stops. The target x
/// follows by a filter with a triple pole, (d/dt + rate)^3 (x - g) = 0, whose exact solution is known, so that it does not
/// depend on when it is read. Three poles for continuity of position, velocity and acceleration, where samples jump and where
/// g stops: torque mode feeds the acceleration forward. A point that moves at constant velocity is followed without lag. One
/// that accelerates by a, in samples T apart, is followed 3 a / rate^2 + 3 a T / (2 rate) behind, as the target hears of
/// its acceleration by jumps of g alone, and a step is within 5 % after 6.3 / rate: 7.5 mm at 1 m/s2 for frequent samples,
/// 9 mm at 50 Hz, and 0.32 s at 20/s. Before the first sample the target rests where it was told to start.
class PointStream {
 public:
  /// Errors: ConfigError for a start that is not finite, or options that are not positive and finite.
  explicit PointStream(const Vector3& start, const StreamOptions& options = {});

  /// False, and nothing changes, for a sample that is not finite or no later than the one before.
  [[nodiscard]] bool put(const PointSample& sample) noexcept;
  Target<PointTarget> target() const;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

/// The same for a rotation, in the space of quaternions: the follower leads along that of x - g and normalises.
class RotationStream {
 public:
  /// Errors: ConfigError for a start that is no rotation, or options that are not positive and finite.
  explicit RotationStream(const Matrix3& start, const StreamOptions& options = {});

  /// False, and nothing changes, for a sample that is not finite, no rotation to 1e-6, or no later than the one before.
  [[nodiscard]] bool put(const RotationSample& sample) noexcept;
  Target<RotationTarget> target() const;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

}  // namespace tope
