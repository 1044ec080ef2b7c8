#include "support/reference_hierarchy.hpp"

#include "support/random_stack.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <algorithm>

namespace tope::test {
namespace {

constexpr double kLost = 1e-7;  // singular value below which a direction is gone

/// Minimises |rows y - target| on y + span(basis), takes the shortest step, and closes the directions it
/// used.
double fit(const Matrix& rows, const Vector& target, Vector& y, Matrix& basis) {
  if (rows.rows() == 0 || basis.cols() == 0) {
    return 1.0;
  }
  const Eigen::JacobiSVD<Matrix> svd(rows * basis, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector& values = svd.singularValues();
  const Eigen::Index rank = (values.array() > kLost).count();
  const Vector components = svd.matrixU().leftCols(rank).transpose() * (target - rows * y);
  y += basis * (svd.matrixV().leftCols(rank) * components.cwiseQuotient(values.head(rank)));
  basis = basis * svd.matrixV().rightCols(basis.cols() - rank);
  return rank > 0 ? values[rank - 1] * values[rank - 1] : 1.0;
}

}  // namespace

ReferenceHierarchy reference_hierarchy(const Stack& stack, const Selection& selection,
                                       const Vector& limit_target, double epsilon) {
  const int n = stack.size();
  ReferenceHierarchy result{.y = Vector::Zero(n)};
  Matrix basis = Matrix::Identity(n, n);

  const Eigen::Index active = std::count(selection.limits.begin(), selection.limits.end(), 1);
  Matrix rows(active, n);
  Vector target(active);
  for (Eigen::Index j = 0, i = 0; j < n; ++j) {
    if (selection.limits[static_cast<std::size_t>(j)] != 0) {
      rows.row(i) = stack.motion.row(j);
      target[i++] = limit_target[j];
    }
  }
  fit(rows, target, result.y, basis);

  const int last = stack.tasks.empty() ? 0 : stack.tasks.back().level;
  for (int level = 1; level <= last; ++level) {
    const Matrix a = level_matrix(stack, selection, level);
    if (a.rows() == 0) {
      continue;
    }
    const Matrix b = a * a.transpose() + epsilon * epsilon * Matrix::Identity(a.rows(), a.rows());
    const Matrix scale = Eigen::SelfAdjointEigenSolver<Matrix>(b).operatorInverseSqrt();
    const double share = fit(scale * a, scale * level_target(stack, selection, level), result.y, basis);
    result.smallest_share = std::min(result.smallest_share, share);
  }
  return result;
}

ReferenceHierarchy reference_hierarchy(const Stack& stack, const Selection& selection, double epsilon) {
  return reference_hierarchy(stack, selection, stack.limit_target, epsilon);
}

}  // namespace tope::test
