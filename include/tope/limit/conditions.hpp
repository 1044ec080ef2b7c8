#pragma once

#include <tope/law/limit_method.hpp>
#include <tope/limit/collision_limits.hpp>
#include <tope/limit/joint_limits.hpp>

#include <string>
#include <vector>

namespace tope {

/// One inequality that the limit guarantee needs when the loop runs at discrete times.
struct Condition {
  std::string name;        ///< short, stable
  std::string joint;       ///< empty when it concerns all
  std::string expression;  ///< in symbols
  double value = 0.0;      ///< left-hand side
  double bound = 0.0;      ///< holds when value <= bound
  std::string advice;      ///< what would satisfy it, in the user's terms

  double margin() const { return bound - value; }
  bool holds() const { return value <= bound; }
};

/// The inequalities of velocity mode at period dt [s] for a method; none for a method that promises nothing.
/// `headroom` (n) is the unilateral law's.
std::vector<Condition> velocity_conditions(const Robot& robot, const JointLimits& limits, LimitMethod method,
                                           const Vector& headroom, double dt);

/// The same of torque mode, for the rows measured on the predicted position and for the unilateral law. `authority` (n)
/// is what each drive can brake with, braking_authority() [rad/s2 or m/s2].
std::vector<Condition> torque_conditions(const Robot& robot, const JointLimits& limits, LimitMethod method,
                                         const Vector& headroom, double dt, const Vector& authority);

/// Largest CollisionLimits::drift() with all joints at full speed, in one direction or the other, over a thousand poses;
/// infinite where a joint has no speed limit. Leaves the distances as they are in the last pose.
double full_speed_drift(const Robot& robot, CollisionLimits& collisions);

/// The inequalities of the distances to keep, beside those of the joints, in velocity mode (`drift` is
/// full_speed_drift()) and in torque mode.
std::vector<Condition> velocity_conditions(const CollisionLimits& collisions, double drift, double dt);
std::vector<Condition> torque_conditions(const CollisionLimits& collisions, const JointLimits& limits,
                                         double dt);

/// A joint's headroom for the unilateral law: `most`, or half of the largest that leaves it an interior, when that is less
/// [rad/s or m/s; of second order: per second more].
double suitable_headroom(const JointLimits& limits, int joint, bool second_order, double most);

/// Largest gain of a joint's limits [1/s], up to JointLimits::default_gain and 0.4 of the servo's, that leaves a fifth of what its
/// drive can brake with (authority) unused and, for methods with rows, both rows idle at rest.
double braking_gain(const JointLimits& limits, LimitMethod method, int joint, double authority);

}  // namespace tope
