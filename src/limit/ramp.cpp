#include <tope/law/smooth_step.hpp>
#include <tope/limit/ramp.hpp>

#include <cmath>
#include <numbers>

namespace tope {

double ramp(Ramp shape, double x) {
  if (x <= 0.0) {
    return 0.0;
  }
  if (x >= 1.0) {
    return 1.0;
  }
  if (shape == Ramp::quintic) {
    return quintic_step(x);
  }
  return 0.5 - 0.5 * std::cos(std::numbers::pi * x);
}

// Maxima of (1 - ramp(1 - x)) / x, rounded up; the test of this file recomputes them.
double ramp_slope_factor(Ramp shape) { return shape == Ramp::quintic ? 1.1978 : 1.1383; }

}  // namespace tope
