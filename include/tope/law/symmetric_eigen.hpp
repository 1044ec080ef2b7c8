#pragma once

#include <tope/common/types.hpp>

#include <Eigen/Eigenvalues>

#include <vector>

namespace tope {

/// Eigen-decompositions of symmetric matrices of any size up to a bound, each with its memory reserved.
class SymmetricEigen {
 public:
  using Solver = Eigen::SelfAdjointEigenSolver<Matrix>;

  explicit SymmetricEigen(int max_size);

  /// Decomposes the m x m matrix; the result stays valid until the next call with the same size.
  const Solver& compute(const Eigen::Ref<const Matrix>& matrix);

 private:
  std::vector<Solver> solvers_;  // solvers_[m - 1] is for size m
};

}  // namespace tope
