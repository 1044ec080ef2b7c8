#pragma once

#include "path_motion.hpp"

#include <tope/common/types.hpp>

#include <vector>

namespace tope {

/// Cubic spline through values (D x waypoints) at rising times; at rest without acceleration before the first and after the
/// last. The end pieces have a knot in between, or the only piece has two, whose values are unknowns like all velocities.
template <int D>
class WaypointSpline {
 public:
  using Values = Eigen::Matrix<double, D, Eigen::Dynamic>;

  WaypointSpline(const std::vector<double>& times, const Values& waypoints);

  PathMotion<D> at(double t) const;
  /// Rising; the first and the last are those of waypoints.
  const std::vector<double>& knots() const { return knots_; }

 private:
  std::vector<double> knots_;
  Values values_;  // at the knots
  Values rates_;   // likewise
};

}  // namespace tope
