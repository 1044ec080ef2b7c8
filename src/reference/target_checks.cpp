#include "target_checks.hpp"

#include "../common/rotation_check.hpp"

#include <tope/common/error.hpp>

#include <sstream>

namespace tope {

void require_finite(const std::string& what, const VectorArg& values) {
  if (!values.allFinite()) {
    std::ostringstream message;
    message << what << ": must be finite, got (" << values.transpose() << ")";
    throw ConfigError(message.str());
  }
}

void require_rotation(const std::string& what, const Matrix3& rotation) {
  if (!is_rotation(rotation)) {
    std::ostringstream message;
    message << what << ": not a rotation: |R^T R - I| = " << deviation_from_rotation(rotation)
            << ", det R = " << rotation.determinant()
            << "; it must be orthonormal to 1e-6 with determinant 1";
    throw ConfigError(message.str());
  }
}

}  // namespace tope
