#include "support/kkt.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <vector>

namespace tope::test {
namespace {

using Rows = std::vector<Eigen::Index>;

/// Least-squares multipliers of the chosen columns, zero for the others.
Vector fit(const Matrix& columns, const Vector& target, const Rows& chosen) {
  Matrix part(columns.rows(), static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    part.col(static_cast<Eigen::Index>(i)) = columns.col(chosen[i]);
  }
  const Vector values = part.completeOrthogonalDecomposition().solve(target);
  Vector result = Vector::Zero(columns.cols());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    result[chosen[i]] = values[static_cast<Eigen::Index>(i)];
  }
  return result;
}

/// Share of the way to `next` on which every chosen multiplier stays positive.
double feasible_step(const Vector& multipliers, const Vector& next, const Rows& chosen) {
  double step = 1.0;
  for (const Eigen::Index i : chosen) {
    if (next[i] <= 0.0) {
      step = std::min(step, multipliers[i] / (multipliers[i] - next[i]));
    }
  }
  return step;
}

}  // namespace

double stationarity_residual(const Vector& gradient, const Matrix& normals) {
  const Matrix columns = normals.transpose();
  const Vector target = -gradient;
  Vector multipliers = Vector::Zero(columns.cols());
  Rows chosen;
  for (Eigen::Index round = 0; round < 3 * columns.cols(); ++round) {
    Vector slope = columns.transpose() * (target - columns * multipliers);
    for (const Eigen::Index i : chosen) {
      slope[i] = -1.0;
    }
    Eigen::Index steepest = 0;
    if (slope.maxCoeff(&steepest) < 1e-13) {
      break;
    }
    chosen.push_back(steepest);
    Vector next = fit(columns, target, chosen);
    for (double step = feasible_step(multipliers, next, chosen); step < 1.0;
         step = feasible_step(multipliers, next, chosen)) {
      multipliers += step * (next - multipliers);
      std::erase_if(chosen, [&](Eigen::Index i) { return multipliers[i] <= 1e-15; });
      next = fit(columns, target, chosen);
    }
    multipliers = next;
  }
  return (target - columns * multipliers).norm();
}

KktResidual kkt_residual(const Matrix& a, const Vector& r, double mu, const Matrix& d, const Vector& lower,
                         const Vector& upper, const Vector& z, double tolerance) {
  const Vector value = d * z;
  KktResidual result;
  result.feasibility = std::max(0.0, (value - upper).cwiseMax(lower - value).maxCoeff());
  std::vector<Vector> normals;
  for (Eigen::Index i = 0; i < d.rows(); ++i) {
    if (value[i] > upper[i] - tolerance) {
      normals.emplace_back(d.row(i));
    }
    if (value[i] < lower[i] + tolerance) {
      normals.emplace_back(-d.row(i));
    }
  }
  Matrix rows(static_cast<Eigen::Index>(normals.size()), z.size());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    rows.row(i) = normals[static_cast<std::size_t>(i)];
  }
  result.stationarity = stationarity_residual(a.transpose() * (a * z - r) + mu * z, rows);
  return result;
}

}  // namespace tope::test
