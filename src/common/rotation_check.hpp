#pragma once

#include <tope/common/types.hpp>

#include <Eigen/LU>

namespace tope {

/// Largest entry of R^T R - I.
inline double deviation_from_rotation(const Matrix3& r) noexcept {
  return (r.transpose() * r - Matrix3::Identity()).cwiseAbs().maxCoeff();
}

/// True where R^T R = I and det R = 1, to 1e-6.
inline bool is_rotation(const Matrix3& r) noexcept {
  return deviation_from_rotation(r) < 1e-6 && r.determinant() > 0.0;
}

}  // namespace tope
