#include <tope/common/error.hpp>
#include <tope/robot/braking_authority.hpp>
#include <tope/robot/robot_terms.hpp>
#include <tope/robot/sampled_pose.hpp>

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>
#include <string>

namespace tope {
namespace {

constexpr double kLeastPivot = 1e-9;  // of the mass matrix; less is no inertia at all [kg or kg m2]

void require_positive_definite(const Robot& robot, const Matrix& mass_matrix) {
  const Vector pivots = mass_matrix.ldlt().vectorD();
  const Eigen::LLT<Matrix> cholesky(mass_matrix);
  if (cholesky.info() == Eigen::Success && pivots.minCoeff() > kLeastPivot) {
    return;
  }
  Eigen::Index joint = 0;
  mass_matrix.diagonal().minCoeff(&joint);
  throw ConfigError(
      "torque mode needs the inertia of every link: " + robot.joint_names()[static_cast<std::size_t>(joint)] +
      " moves no mass; give the links beyond it an <inertial> in the URDF, or the joint a rotor_inertia");
}

}  // namespace

Vector braking_authority(const Robot& robot) {
  RobotTerms terms(robot);
  const Vector at_rest = Vector::Zero(robot.nv());
  Vector authority = Vector::Constant(robot.nv(), std::numeric_limits<double>::infinity());
  for (int k = 0; k < sampled_poses; ++k) {
    terms.update_dynamics(sampled_pose(robot, k), at_rest);
    if (k == 0) {
      require_positive_definite(robot, terms.mass_matrix());
    }
    const Matrix inverse = terms.mass_matrix().llt().solve(Matrix::Identity(robot.nv(), robot.nv()));
    const Vector spare = robot.effort_limit() - terms.bias().cwiseAbs();
    authority = authority.cwiseMin(spare.cwiseProduct(inverse.diagonal()));
  }
  return authority.cwiseMax(0.0);
}

}  // namespace tope
