#include <tope/law/symmetric_eigen.hpp>

#include <Eigen/Householder>

namespace tope {

SymmetricEigen::Solver::Solver(Eigen::Index size)
    : reduced_(size, size),
      basis_(size, size),
      reflector_(size),
      diagonal_(size),
      subdiagonal_(size - 1),
      workspace_(size),
      tridiagonal_(size),
      values_(size),
      vectors_(Matrix::Identity(size, size)) {}

void SymmetricEigen::Solver::compute(const Eigen::Ref<const Matrix>& matrix) {
  const Eigen::Index size = values_.size();
  if (size == 1) {
    values_[0] = matrix(0, 0);
    return;
  }
  reduced_ = matrix;
  basis_.setIdentity();
  for (Eigen::Index i = 0; i + 2 < size; ++i) {
    const Eigen::Index below = size - 1 - i;
    auto reflector = reflector_.head(below - 1);
    double tau = 0.0;
    double length = 0.0;
    reduced_.col(i).tail(below).makeHouseholder(reflector, tau, length);
    reduced_.bottomRows(below).applyHouseholderOnTheLeft(reflector, tau, workspace_.data());
    reduced_.rightCols(below).applyHouseholderOnTheRight(reflector, tau, workspace_.data());
    basis_.rightCols(below).applyHouseholderOnTheRight(reflector, tau, workspace_.data());
  }
  diagonal_ = reduced_.diagonal();
  subdiagonal_ = reduced_.diagonal<-1>();
  tridiagonal_.computeFromTridiagonal(diagonal_, subdiagonal_);
  values_ = tridiagonal_.eigenvalues();
  vectors_.noalias() = basis_ * tridiagonal_.eigenvectors();
}

SymmetricEigen::SymmetricEigen(int max_size) {
  solvers_.reserve(static_cast<std::size_t>(max_size));
  for (int size = 1; size <= max_size; ++size) {
    solvers_.emplace_back(size);
  }
}

const SymmetricEigen::Solver& SymmetricEigen::compute(const Eigen::Ref<const Matrix>& matrix) {
  Solver& solver = solvers_[static_cast<std::size_t>(matrix.rows() - 1)];
  solver.compute(matrix);
  return solver;
}

}  // namespace tope
