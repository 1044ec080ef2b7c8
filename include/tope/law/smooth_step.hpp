#pragma once

namespace tope {

/// 3 x^2 - 2 x^3 on [0, 1], constant outside.
inline double smooth_step(double x) {
  if (x <= 0.0) {
    return 0.0;
  }
  return x >= 1.0 ? 1.0 : x * x * (3.0 - 2.0 * x);
}

}  // namespace tope
