#include <tope/common/error.hpp>
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
  const Eigen::LLT<Eigen::Ref<Matrix>> cholesky(command_);
  motion_.setIdentity();
  cholesky.matrixU().solveInPlace(motion_);
  command_.triangularView<Eigen::StrictlyUpper>().setZero();
}

void Whitening::from_command(const Vector& u, Vector& y) const {
  y = u;
  command_.triangularView<Eigen::Lower>().solveInPlace(y);
}

}  // namespace tope
