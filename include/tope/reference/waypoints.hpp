#pragma once

#include <tope/reference/target.hpp>

#include <vector>

namespace tope {

/// A point to be passed at a time.
struct PointWaypoint {
  double time = 0.0;  ///< [s]
  Vector3 position;   ///< [m]
};

/// A rotation to be passed at a time.
struct RotationWaypoint {
  double time = 0.0;  ///< [s]
  Matrix3 rotation;   ///< world_R_target
};

/// A motion through points at their times, along a cubic spline. It waits at the first until its time and stays at the
/// last; velocity and acceleration are continuous at all times, zero at both ends. (A spline of as many pieces as there are
/// waypoints in between could not end with zero acceleration: two knots in the end pieces, whose points it chooses itself,
/// make up for that.) Errors: ConfigError for less than two waypoints, times that are not finite or do not rise, points
/// that are not finite.
Target<PointTarget> through(const std::vector<PointWaypoint>& waypoints);

/// The same for rotations, along the spline of their quaternions, normalised: like the points', it does not depend on the
/// axes it is told in. Errors: also for what is no rotation, and for steps of more than 2.5 rad: their way is not clear.
Target<RotationTarget> through(const std::vector<RotationWaypoint>& waypoints);

}  // namespace tope
