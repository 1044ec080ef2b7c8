#pragma once

#include "support/loop.hpp"

#include <algorithm>

namespace tope::test {

/// Watches the largest change of a command between cycles, over each joint's bound.
struct Jump {
  explicit Jump(const Loop& watched) : loop(watched) {}

  void operator()() {
    const Vector& bound = loop.body ? loop.robot.effort_limit() : loop.robot.velocity_limit();
    if (last.size() > 0) {
      largest = std::max(largest, (loop.u - last).cwiseQuotient(bound).cwiseAbs().maxCoeff());
    }
    last = loop.u;
  }

  const Loop& loop;
  Vector last;
  double largest = 0.0;
};

}  // namespace tope::test
