#pragma once

namespace tope {

/// Shape of an activation across its buffer.
enum class Ramp {
  raised_cosine,  ///< (24)-(25) of the paper
  quintic,        ///< 6 x^5 - 15 x^4 + 10 x^3: continuous second derivative
};

/// 0 for x <= 0, 1 for x >= 1, monotonic between.
double ramp(Ramp shape, double x);

/// kappa = sup over x of (1 - ramp(1 - x)) / x: how far a joint's allowed speed can exceed the linear one in
/// the buffer.
double ramp_slope_factor(Ramp shape);

}  // namespace tope
