#pragma once

#include <cmath>

namespace tope {

/// The turn by the smaller angle that makes the element between two coordinates of a symmetric matrix zero.
struct JacobiRotation {
  /// `difference`: second diagonal element less the first; `off`: the element between them.
  JacobiRotation(double difference, double off) {
    const double radius = std::sqrt(difference * difference + 4.0 * off * off);
    if (!(radius > 0.0)) {
      return;
    }
    const double sum = std::abs(difference) + radius;
    tangent = std::copysign(2.0, difference) * off / sum;
    cosine = std::sqrt(sum / (2.0 * radius));
    sine = tangent * cosine;
  }

  double tangent = 0.0;
  double cosine = 1.0;
  double sine = 0.0;
};

}  // namespace tope
