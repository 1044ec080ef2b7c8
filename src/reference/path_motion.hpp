#pragma once

#include <tope/reference/target.hpp>

namespace tope {

/// Where a path in D dimensions is at one moment, with its first and second derivative by time.
template <int D>
struct PathMotion {
  using Value = Eigen::Matrix<double, D, 1>;
  Value value;
  Value rate;
  Value acceleration;
};

inline PointTarget point_on(const PathMotion<3>& motion) {
  return {.position = motion.value, .velocity = motion.rate, .acceleration = motion.acceleration};
}

}  // namespace tope
