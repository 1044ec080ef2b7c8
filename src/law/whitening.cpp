#include <tope/common/error.hpp>
#include <tope/law/small_cholesky.hpp>
#include <tope/law/whitening.hpp>

#include <Eigen/Cholesky>

namespace tope {

Whitening Whitening::velocity(const Matrix& weight) {
  const Eigen::LLT<Matrix> cholesky(weight);
  if (cholesky.info() != Eigen::Success || !weight.isApprox(weight.transpose(), 1e-12)) {
    throw ConfigError("the weight of the velocity mode must be symmetric and positive definite");
  }
  Whitening whitening;
  whitening.command_ = cholesky.matrixL();
  whitening.motion_ = whitening.command_;
  whitening.identity_ = weight.isIdentity(0.0);
  return whitening;
}

Whitening Whitening::torque(int n) {
  Whitening whitening;
  whitening.command_ = Matrix::Identity(n, n);
  whitening.motion_ = Matrix::Identity(n, n);
  return whitening;
}

void Whitening::set_mass_matrix(const Matrix& mass_matrix) {
  command_ = mass_matrix;
  factorise_in_place(command_);
  command_.triangularView<Eigen::StrictlyUpper>().setZero();
  // T = L^-T is upper triangular: column j takes the first j + 1 rows alone
  const Eigen::Index n = command_.rows();
  motion_.setZero();
  for (Eigen::Index j = 0; j < n; ++j) {
    motion_(j, j) = 1.0;
    solve_upper(command_.topLeftCorner(j + 1, j + 1), motion_.col(j).head(j + 1));
  }
}

void Whitening::from_command(const Vector& u, Vector& y) const {
  y = u;
  command_.triangularView<Eigen::Lower>().solveInPlace(y);
}

}  // namespace tope
