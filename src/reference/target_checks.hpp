#pragma once

#include <tope/common/types.hpp>

#include <string>

namespace tope {

/// Errors: ConfigError when a value is NaN or infinite.
void require_finite(const std::string& what, const VectorArg& values);

/// Errors: ConfigError unless R^T R = I and det R = 1, to 1e-6.
void require_rotation(const std::string& what, const Matrix3& rotation);

}  // namespace tope
