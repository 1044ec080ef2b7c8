#include <tope/common/error.hpp>
#include <tope/robot/braking_authority.hpp>
#include <tope/robot/robot_terms.hpp>

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace tope {
namespace {

constexpr int kPoses = 1000;
constexpr double kTurn = 2.0 * std::numbers::pi;  // looked at where a joint has no limit [rad or m]
constexpr double kLeastPivot = 1e-9;  // of the mass matrix; less is no inertia at all [kg or kg m2]

/// The k-th point of Roberts' additive sequence in [0, 1)^n, which fills the cube evenly for every n.
Vector evenly_spread(int k, Eigen::Index n) {
  double root = 2.0;  // of x^(n + 1) = x + 1
  for (int i = 0; i < 40; ++i) {
    root = std::pow(1.0 + root, 1.0 / static_cast<double>(n + 1));
  }
  Vector point(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double x = 0.5 + (k + 1) * std::pow(root, -static_cast<double>(j + 1));
    point[j] = x - std::floor(x);
  }
  return point;
}

Vector pose(const Robot& robot, int k) {
  Vector q = evenly_spread(k, robot.nq());
  for (int j = 0; j < robot.nq(); ++j) {
    const double lower = robot.position_lower()[j];
    const double upper = robot.position_upper()[j];
    if (std::isfinite(lower)) {
      q[j] = lower + q[j] * (std::isfinite(upper) ? upper - lower : kTurn);
    } else {
      q[j] = (std::isfinite(upper) ? upper : 0.5 * kTurn) - q[j] * kTurn;
    }
  }
  return q;
}

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
  for (int k = 0; k < kPoses; ++k) {
    terms.update_dynamics(pose(robot, k), at_rest);
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
