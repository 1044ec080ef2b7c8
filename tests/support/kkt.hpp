#pragma once

#include <tope/common/types.hpp>

namespace tope::test {

/// Smallest |gradient + normals^T multipliers| over multipliers >= 0, by Lawson and Hanson's non-negative
/// least squares: zero at a minimum whose active constraints have these outward normals (rows), however they
/// depend on each other.
double stationarity_residual(const Vector& gradient, const Matrix& normals);

/// How far z is from being the minimum of |A z - r|^2 + mu |z|^2 subject to lower <= D z <= upper,
/// independent of any multipliers that a solver may give. Rows within `tolerance` of a bound count as active.
struct KktResidual {
  double feasibility = 0.0;   ///< largest violation of a bound
  double stationarity = 0.0;  ///< of the half-squared problem
};
KktResidual kkt_residual(const Matrix& a, const Vector& r, double mu, const Matrix& d, const Vector& lower,
                         const Vector& upper, const Vector& z, double tolerance);

}  // namespace tope::test
