#pragma once

#include <tope/reference/target.hpp>

namespace tope {

/// A goal that someone drags, or that arrives in messages: it follows where it was last put like a critically damped
/// spring, so that position, velocity and acceleration of the target fit each other and a command does not jump.
/// Never allocates: a moving target may read it in the loop.
class LiveGoal {
 public:
  LiveGoal(const Vector3& position, const Matrix3& rotation);

  /// Where the goal is to go: position [m], world_R_goal.
  void put(const Vector3& position, const Matrix3& rotation);
  /// Follows for dt [s].
  void advance(double dt);

  const Vector3& put_position() const { return put_position_; }
  const Matrix3& put_rotation() const { return put_rotation_; }
  const PointTarget& point() const { return point_; }
  const RotationTarget& rotation() const { return rotation_; }

 private:
  Vector3 put_position_;
  Matrix3 put_rotation_;
  PointTarget point_;
  RotationTarget rotation_;
};

}  // namespace tope
