#pragma once

#include <Eigen/Core>

namespace tope {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

/// Read-only argument of any dense vector; never copies a contiguous one.
using VectorArg = Eigen::Ref<const Eigen::VectorXd>;

}  // namespace tope
