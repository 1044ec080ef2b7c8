#pragma once

#include <tope/common/types.hpp>

namespace tope {

/// Keeps a command inside lower <= u <= upper by scaling what the tasks add: u = first + s (u - first) with the
/// largest s in [0, 1], `first` being what the limits (and the bias) ask for. Keeps the direction of the tasks'
/// share, and is continuous as long as every bound leaves `first` some room. Where `first` alone is beyond a bound,
/// it is clipped there.
struct CommandBounds {
  double scale = 1.0;     ///< s
  int clipped = -1;       ///< joint whose `first` was clipped, or -1
  int most_binding = -1;  ///< joint that decided s, or -1

  /// All vectors (n). Changes `command` and, where it is beyond a bound, `first`.
  static CommandBounds apply(const Vector& lower, const Vector& upper, Vector& first, Vector& command);
};

}  // namespace tope
