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
      acceleration_upper_(Vector::Constant(robot.nv(), std::numeric_limits<double>::infinity())),
      asked_(Vector::Zero(robot.nv())),
      block_(robot.nv(), robot.nv()),
      factor_(robot.nv()),
      missed_(Vector::Zero(PanelMatrix::padded(robot.nv()))) {
  const Eigen::Index n = robot.nv();
  short_of_.reserve(static_cast<std::size_t>(n));
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

CommandBounds TorqueBounds::apply(const Matrix& mass_matrix, double yaw, const Vector& first_acceleration,
                                  Vector& first_torque, Vector& acceleration, Vector& torque) {
  const Eigen::Index n = torque.size();
  lower_.head(n) = acceleration_lower_;
  upper_.head(n) = acceleration_upper_;
  fill(first_acceleration, first_torque, yaw, first_);
  fill(acceleration, torque, yaw, command_);

  acceleration -= first_acceleration;
  torque -= first_torque;
  CommandBounds result = CommandBounds::apply(lower_, upper_, first_, command_);
  const int clipped = result.clipped;
  if (clipped >= 0) {
    asked_ = first_torque;
    clip(yaw, first_torque);
    keep_the_others(mass_matrix, asked_, first_torque);
    clip(yaw, first_torque);
    fill(first_acceleration, first_torque, yaw, first_);
    fill(acceleration, torque, yaw, command_);  // of the tasks' share
    command_ += first_;
    result = CommandBounds::apply(lower_, upper_, first_, command_);
  }
  acceleration = first_acceleration + result.scale * acceleration;
  torque = first_torque + result.scale * torque;
  result.clipped = joint_of(clipped);
  result.most_binding = joint_of(result.most_binding);
  return result;
}

void TorqueBounds::clip(double yaw, Vector& torque) {
  const Eigen::Index n = torque.size();
  torque = torque.cwiseMax(lower_.segment(n, n)).cwiseMin(upper_.segment(n, n));
  if (robot_.base()) {  // the wrench keeps its direction
    wheels_.noalias() = wheel_rows_ * robot_.base()->base_wrench(torque, yaw);
    const double peak = wheels_.cwiseAbs().maxCoeff();
    for (const int joint : robot_.base()->options().joints) {
      torque[joint] *= std::min(1.0, wheel_bound_ / std::max(peak, wheel_bound_));
    }
  }
}

/// A clipped joint accelerates less than asked, and would push the others off what they were asked, through their limits.
void TorqueBounds::keep_the_others(const Matrix& mass_matrix, const Vector& asked, Vector& torque) {
  short_of_.clear();
  for (int j = 0; j < torque.size(); ++j) {
    if (torque[j] != asked[j]) {
      short_of_.push_back(j);
    }
  }
  const auto count = static_cast<Eigen::Index>(short_of_.size());
  block_.resize_for_rows(count, count);
  missed_.setZero();
  for (Eigen::Index i = 0; i < count; ++i) {
    const int joint = short_of_[static_cast<std::size_t>(i)];
    missed_[i] = torque[joint] - asked[joint];
    for (Eigen::Index k = 0; k < count; ++k) {
      block_(i, k) = mass_matrix(joint, short_of_[static_cast<std::size_t>(k)]);
    }
  }
  if (count == 0 || !factor_.factorise(block_)) {
    return;
  }
  factor_.solve(missed_.data());
  for (int j = 0; j < torque.size(); ++j) {
    if (torque[j] == asked[j]) {
      for (Eigen::Index k = 0; k < count; ++k) {
        torque[j] += mass_matrix(j, short_of_[static_cast<std::size_t>(k)]) * missed_[k];
      }
    }
  }
}

}  // namespace tope
