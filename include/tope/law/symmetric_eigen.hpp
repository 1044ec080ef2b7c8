#pragma once

#include <tope/law/panel_matrix.hpp>

#include <Eigen/Eigenvalues>

#include <vector>

namespace tope {

/// Eigen-decompositions of symmetric matrices of any size up to a bound, each with its memory reserved: in closed form for
/// three rows, the usual size of a task, by Jacobi's rotations for one, two and four, and by Eigen's tridiagonal solver above.
/// (Eigen's own compute() takes its workspace from the heap.)
class SymmetricEigen {
 public:
  /// One size's memory and result: M = V diag(values) V^T, values in ascending order.
  class Solver {
   public:
    explicit Solver(Eigen::Index size);

    void compute(const PanelMatrix& matrix);

    const Vector& eigenvalues() const { return values_; }
    const Matrix& eigenvectors() const { return vectors_; }  ///< one a column

   private:
    void split_off(const PanelMatrix& matrix);
    template <int size>
    void rotate();
    void reduce();

    Matrix reduced_;  // M, then its tridiagonal form T: M = Q T Q^T
    Matrix basis_;    // Q
    Vector reflector_;
    Vector diagonal_;
    Vector subdiagonal_;
    Vector workspace_;
    Eigen::SelfAdjointEigenSolver<Matrix> tridiagonal_;
    Vector values_;
    Matrix vectors_;
  };

  explicit SymmetricEigen(int max_size);

  /// Decomposes the m x m matrix, of which the lower triangle is read; the result stays valid until the next call with
  /// the same size.
  const Solver& compute(const PanelMatrix& matrix);

 private:
  std::vector<Solver> solvers_;  // solvers_[m - 1] is for size m
};

}  // namespace tope
