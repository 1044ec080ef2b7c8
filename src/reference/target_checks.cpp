#include "target_checks.hpp"

#include <tope/common/error.hpp>

#include <Eigen/Dense>

#include <sstream>

namespace tope {

void require_finite(const std::string& what, const VectorArg& values) {
  if (!values.allFinite()) {
    std::ostringstream message;
    message << what << ": must be finite, got (" << values.transpose() << ")";
    throw ConfigError(message.str());
  }
}

namespace {

double deviation_from_rotation(const Matrix3& rotation) {
  return (rotation.transpose() * rotation - Matrix3::Identity()).cwiseAbs().maxCoeff();
}

}  // namespace

bool is_rotation(const Matrix3& rotation) noexcept {
  return deviation_from_rotation(rotation) < 1e-6 && rotation.determinant() > 0.0;
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
