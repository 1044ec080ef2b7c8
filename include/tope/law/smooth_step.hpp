#pragma once

#include <Eigen/Core>

namespace tope {

/// 3 x^2 - 2 x^3 on [0, 1], constant outside.
inline double smooth_step(double x) {
  if (x <= 0.0) {
    return 0.0;
  }
  return x >= 1.0 ? 1.0 : x * x * (3.0 - 2.0 * x);
}

/// The same of each number of a fixed-size array, without branches.
template <typename Derived>
Derived::PlainObject smooth_step(const Eigen::ArrayBase<Derived>& x) {
  const typename Derived::PlainObject within = x.max(0.0).min(1.0);
  return within * within * (3.0 - 2.0 * within);
}

/// 10 x^3 - 15 x^4 + 6 x^5 on [0, 1], constant outside.
inline double quintic_step(double x) {
  if (x <= 0.0) {
    return 0.0;
  }
  return x >= 1.0 ? 1.0 : x * x * x * (10.0 + x * (6.0 * x - 15.0));
}

}  // namespace tope
