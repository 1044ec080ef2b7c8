#pragma once

#include <tope/robot/robot.hpp>

#include <cmath>

namespace tope {

/// A position like any other (nq): what is zero there is zero nearly everywhere.
inline Vector generic_position(const Robot& robot) {
  Vector q(robot.nq());
  for (int j = 0; j < robot.nq(); ++j) {
    q[j] = std::sin(1.0 + 1.7 * j);
  }
  return q;
}

}  // namespace tope
