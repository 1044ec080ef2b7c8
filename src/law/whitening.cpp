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
  whitening.motion_ = cholesky.matrixL();
  return whitening;
}

}  // namespace tope
