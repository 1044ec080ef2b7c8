#pragma once

#include <tope/common/error.hpp>

#include <cmath>
#include <string>

namespace tope {

/// Errors: ConfigError, beginning with `what`, unless the value is positive and finite.
inline void require_positive(const std::string& what, double value) {
  if (!std::isfinite(value) || value <= 0.0) {
    throw ConfigError(what + " must be positive and finite, got " + std::to_string(value));
  }
}

}  // namespace tope
