#include <tope/law/symmetric_eigen.hpp>

namespace tope {

SymmetricEigen::SymmetricEigen(int max_size) {
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
