#include "quaternion_motion.hpp"
#include "target_checks.hpp"
#include "waypoint_spline.hpp"

#include <tope/common/error.hpp>
#include <tope/reference/waypoints.hpp>

#include <cmath>
#include <functional>
#include <memory>
#include <string>

namespace tope {
namespace {

constexpr double kLargestStep = 2.5;  // between rotations [rad]

std::string place(std::size_t index) { return "waypoint " + std::to_string(index); }

template <typename Waypoint>
std::vector<double> rising_times(const std::vector<Waypoint>& waypoints) {
  if (waypoints.size() < 2) {
    throw ConfigError("expected at least 2 waypoints, got " + std::to_string(waypoints.size()));
  }
  std::vector<double> times;
  for (const Waypoint& waypoint : waypoints) {
    if (!std::isfinite(waypoint.time)) {
      throw ConfigError(place(times.size()) + ": its time must be finite [s]");
    }
    if (!times.empty() && waypoint.time <= times.back()) {
      throw ConfigError(place(times.size()) + ": its time " + std::to_string(waypoint.time) +
                        " s must be later than the one before, " + std::to_string(times.back()) + " s");
    }
    times.push_back(waypoint.time);
  }
  return times;
}

/// Where the quaternions' spline passes zero, the rotation would flip.
void require_far_from_zero(const WaypointSpline<4>& spline) {
  constexpr double least = 0.3;
  constexpr int samples = 16;  // of a piece
  const std::vector<double>& knots = spline.knots();
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    for (int k = 0; k < samples; ++k) {
      const double t = knots[i] + (knots[i + 1] - knots[i]) * k / samples;
      if (spline.at(t).value.norm() < least) {
        throw ConfigError("the rotations swing too far at " + std::to_string(t) +
                          " s: add one there, or give the turn before or after it more time");
      }
    }
  }
}

}  // namespace

Target<PointTarget> through(const std::vector<PointWaypoint>& waypoints) {
  const std::vector<double> times = rising_times(waypoints);
  WaypointSpline<3>::Values points(3, static_cast<Eigen::Index>(waypoints.size()));
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    require_finite(place(i), waypoints[i].position);
    points.col(static_cast<Eigen::Index>(i)) = waypoints[i].position;
  }
  const auto spline = std::make_shared<const WaypointSpline<3>>(times, points);
  return Target<PointTarget>(
      std::function<PointTarget(double)>([spline](double t) { return point_on(spline->at(t)); }));
}

Target<RotationTarget> through(const std::vector<RotationWaypoint>& waypoints) {
  const std::vector<double> times = rising_times(waypoints);
  WaypointSpline<4>::Values quaternions(4, static_cast<Eigen::Index>(waypoints.size()));
  Eigen::Vector4d last = Eigen::Vector4d::UnitX();
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    require_rotation(place(i), waypoints[i].rotation);
    const Eigen::Vector4d q = quaternion_near(waypoints[i].rotation, last);
    if (i > 0 && q.dot(last) < std::cos(0.5 * kLargestStep)) {
      throw ConfigError(place(i) + ": turns by more than " + std::to_string(kLargestStep) +
                        " rad from the one before, its way is not clear; add a rotation between the two");
    }
    quaternions.col(static_cast<Eigen::Index>(i)) = last = q;
  }
  const auto spline = std::make_shared<const WaypointSpline<4>>(times, quaternions);
  require_far_from_zero(*spline);
  return Target<RotationTarget>(
      std::function<RotationTarget(double)>([spline](double t) { return rotation_on(spline->at(t)); }));
}

}  // namespace tope
