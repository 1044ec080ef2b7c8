#include <tope/common/error.hpp>
#include <tope/law/whitening.hpp>

#include <Eigen/Cholesky>

#include <utility>

namespace tope {
namespace {

/// J T for the usual sizes of a task, which Eigen's general product is slow at, and an upper triangular T.
template <int rows>
void multiply_upper(const Matrix& jacobian, const Matrix& motion, Matrix& a) {
  using Rows = Eigen::Matrix<double, rows, Eigen::Dynamic>;
  const Eigen::Map<const Rows> in(jacobian.data(), rows, jacobian.cols());
  Eigen::Map<Rows> out(a.data(), rows, a.cols());
  for (Eigen::Index j = 0; j < motion.cols(); ++j) {
    Eigen::Matrix<double, rows, 1> sum = Eigen::Matrix<double, rows, 1>::Zero();
    for (Eigen::Index k = 0; k <= j; ++k) {
      sum += motion(k, j) * in.col(k);
    }
    out.col(j) = sum;
  }
}

}  // namespace

Whitening::Whitening(Matrix motion)
    : motion_(std::move(motion)),
      mass_matrix_(motion_.rows(), motion_.rows()),
      factor_(motion_.rows()),
      inverse_(motion_.rows(), motion_.rows()) {}

Whitening Whitening::velocity(const Matrix& weight) {
  const Eigen::LLT<Matrix> cholesky(weight);
  if (cholesky.info() != Eigen::Success || !weight.isApprox(weight.transpose(), 1e-12)) {
    throw ConfigError("the weight of the velocity mode must be symmetric and positive definite");
  }
  Whitening whitening(cholesky.matrixL());
  whitening.identity_ = weight.isIdentity(0.0);
  return whitening;
}

Whitening Whitening::torque(int n) {
  Whitening whitening(Matrix::Identity(n, n));
  whitening.upper_ = true;
  return whitening;
}

void Whitening::rows(const Matrix& jacobian, Matrix& a) const {
  a.resize(jacobian.rows(), jacobian.cols());
  if (identity_) {
    a = jacobian;
  } else if (upper_ && jacobian.rows() == 3) {
    multiply_upper<3>(jacobian, motion_, a);
  } else {
    a.noalias() = jacobian * motion_;
  }
}

void Whitening::set_mass_matrix(const Matrix& mass_matrix) {
  mass_matrix_.set_rows(0, mass_matrix);
  factor_.factorise(mass_matrix_);
  factor_.invert_factor(inverse_);
  for (Eigen::Index j = 0; j < motion_.cols(); ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) {
      motion_(i, j) = inverse_(j, i);
    }
  }
}

}  // namespace tope
