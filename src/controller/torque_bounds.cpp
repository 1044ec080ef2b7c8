#include <tope/controller/torque_bounds.hpp>

#include <algorithm>
#include <limits>

namespace tope {
namespace {

/// Rows of the base wrench that the wheels' bound limits: the least-norm torques themselves, or, since the least
/// peak is (max g - min g) / 2 with g the least-norm torques turned by the idle pattern, all halved differences.
Matrix wheel_rows(const MecanumBase& base, WheelDistribution distribution) {
  Matrix torques(4, 3);
  for (int i = 0; i < 3; ++i) {
    torques.col(i) = base.minimum_norm_torques(Eigen::Vector3d::Unit(i));
  }
  if (distribution == WheelDistribution::minimum_norm) {
    return torques;
  }
  torques.bottomRows(2) *= -1.0;
  Matrix halved_differences(6, 3);
  int row = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      halved_differences.row(row++) = 0.5 * (torques.row(i) - torques.row(j));
    }
  }
  return halved_differences;
}

}  // namespace

TorqueBounds::TorqueBounds(const Robot& robot, WheelDistribution distribution)
    : robot_(robot),
      wheel_rows_(robot.base() ? wheel_rows(*robot.base(), distribution) : Matrix(0, 3)),
      wheels_(Vector::Zero(wheel_rows_.rows())),
      acceleration_lower_(Vector::Constant(robot.nv(), -std::numeric_limits<double>::infinity())),
      acceleration_upper_(Vector::Constant(robot.nv(), std::numeric_limits<double>::infinity())) {
  const Eigen::Index n = robot.nv();
  upper_ = Vector::Zero(2 * n + wheel_rows_.rows());
  upper_.segment(n, n) = robot.effort_limit();
  if (robot.base()) {
    wheel_bound_ = robot.base()->options().wheel_effort_limit;
    upper_.tail(wheel_rows_.rows()).setConstant(wheel_bound_);
  }
  lower_ = -upper_;
  first_ = Vector::Zero(upper_.size());
  command_ = Vector::Zero(upper_.size());
}

void TorqueBounds::fill(const Vector& acceleration, const Vector& torque, double yaw, Vector& rows) const {
  const Eigen::Index n = torque.size();
  rows.head(n) = acceleration;
  rows.segment(n, n) = torque;
  if (robot_.base()) {
    rows.tail(wheel_rows_.rows()).noalias() = wheel_rows_ * robot_.base()->base_wrench(torque, yaw);
  }
}

int TorqueBounds::joint_of(int row) const {
  const int n = robot_.nv();
  if (row < 2 * n) {
    return row < 0 ? row : row % n;
  }
  const std::optional<MecanumBase>& base = robot_.base();
  return base ? base->options().joints[0] : -1;
}

CommandBounds TorqueBounds::apply(const Vector& first_acceleration, Vector& first_torque, double yaw,
                                  Vector& acceleration, Vector& torque) {
  const Eigen::Index n = torque.size();
  lower_.head(n) = acceleration_lower_;
  upper_.head(n) = acceleration_upper_;
  fill(first_acceleration, first_torque, yaw, first_);
  fill(acceleration, torque, yaw, command_);

  acceleration -= first_acceleration;
  torque -= first_torque;
  CommandBounds result = CommandBounds::apply(lower_, upper_, first_, command_);
  if (result.clipped >= 0) {
    first_torque = first_torque.cwiseMax(lower_.segment(n, n)).cwiseMin(upper_.segment(n, n));
    if (robot_.base()) {  // the wrench keeps its direction
      wheels_.noalias() = wheel_rows_ * robot_.base()->base_wrench(first_torque, yaw);
      const double peak = wheels_.cwiseAbs().maxCoeff();
      for (const int joint : robot_.base()->options().joints) {
        first_torque[joint] *= std::min(1.0, wheel_bound_ / std::max(peak, wheel_bound_));
      }
    }
  }
  acceleration = first_acceleration + result.scale * acceleration;
  torque = first_torque + result.scale * torque;
  result.clipped = joint_of(result.clipped);
  result.most_binding = joint_of(result.most_binding);
  return result;
}

}  // namespace tope
