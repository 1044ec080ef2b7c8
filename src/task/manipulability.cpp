#include "../common/require_positive.hpp"
#include "distinct_joints.hpp"
#include "generic_position.hpp"

#include <tope/common/error.hpp>
#include <tope/task/manipulability.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace tope {
namespace {

constexpr double kSmoothing = 0.05;  // s / w_d

std::vector<int> checked_rows(const std::vector<int>& rows) {
  if (rows.empty()) {
    throw ConfigError("Manipulability: rows: names no row");
  }
  for (auto row = rows.begin(); row != rows.end(); ++row) {
    if (*row < 0 || *row > 5) {
      throw ConfigError("Manipulability: rows: a frame has rows 0 to 5, got " + std::to_string(*row));
    }
    if (std::find(rows.begin(), row, *row) != row) {
      throw ConfigError("Manipulability: rows: row " + std::to_string(*row) + " is named twice");
    }
  }
  return rows;
}

std::vector<int> joints_or_all(const Robot& robot, const std::vector<std::string>& names) {
  if (!names.empty()) {
    return distinct_joints(robot, names, "Manipulability: joints:");
  }
  std::vector<int> joints(static_cast<std::size_t>(robot.nv()));
  std::iota(joints.begin(), joints.end(), 0);
  return joints;
}

using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Adds how fast `columns` (v over w) change as joints of the columns `movers` move: what carries a joint turns its column,
/// and joints after it shift the frame, which adds to its v.
void add_rates(const Columns& movers, const Columns& columns, const Vector& velocity, Columns& rates) {
  Vector3 turn = Vector3::Zero();
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    turn += velocity[j] * movers.col(j).tail<3>();
    const Vector3 linear = columns.col(j).head<3>();
    const Vector3 angular = columns.col(j).tail<3>();
    rates.col(j).head<3>() += turn.cross(linear);
    rates.col(j).tail<3>() += turn.cross(angular);
  }
  Vector3 shift = Vector3::Zero();
  for (Eigen::Index j = columns.cols() - 1; j >= 0; --j) {
    const Vector3 angular = columns.col(j).tail<3>();
    rates.col(j).head<3>() += angular.cross(shift);
    shift += velocity[j] * movers.col(j).head<3>();
  }
}

}  // namespace

Manipulability::Manipulability(const Robot& robot, const std::string& frame, double target,
                               const ManipulabilityOptions& options, Reference reference)
    : Task(1, robot.nv(), std::move(reference)),
      frame_(robot.frame_index(frame)),
      target_(target),
      rows_(checked_rows(options.rows)),
      joints_(joints_or_all(robot, options.joints)),
      by_column_(Columns::Zero(6, robot.nv())),
      rate_(Columns::Zero(6, robot.nv())),
      acceleration_(Columns::Zero(6, robot.nv())) {
  require_positive("Manipulability: target", target);
  require_measurable(robot);
}

void Manipulability::require_measurable(const Robot& robot) {
  RobotTerms terms(robot);
  terms.update(generic_position(robot), Vector::Zero(robot.nv()));
  evaluate(terms, 0.0);
  if (eigenvalues_[0] <= 1e-9 * eigenvalues_[eigenvalues_.size() - 1]) {  // they rise
    throw ConfigError("Manipulability: the joints cannot move frame '" + robot.frame_name(frame_) +
                      "' along all of its " + std::to_string(rows_.size()) +
                      " rows: w is zero in every state");
  }
}

/// A B^T of the rows and columns that count.
Manipulability::Square Manipulability::product(const Columns& a, const Columns& b) const {
  const auto size = static_cast<Eigen::Index>(rows_.size());
  Square result = Square::Zero(size, size);
  for (const int joint : joints_) {
    for (Eigen::Index i = 0; i < size; ++i) {
      for (Eigen::Index j = 0; j < size; ++j) {
        result(i, j) +=
            a(rows_[static_cast<std::size_t>(i)], joint) * b(rows_[static_cast<std::size_t>(j)], joint);
      }
    }
  }
  return result;
}

/// Product of all eigenvalues but those numbered i and j: derivatives of the determinant that divide by none of them.
double Manipulability::product_without(Eigen::Index i, Eigen::Index j) const {
  double result = 1.0;
  for (Eigen::Index k = 0; k < eigenvalues_.size(); ++k) {
    result *= k == i || k == j ? 1.0 : eigenvalues_[k];
  }
  return result;
}

void Manipulability::evaluate(const RobotTerms& terms, double /*t*/) {
  const Columns& columns = terms.frame_jacobian(frame_);
  const Eigen::SelfAdjointEigenSolver<Square> eigen(product(columns, columns));
  eigenvalues_ = eigen.eigenvalues().cwiseMax(0.0);
  eigenvectors_ = eigen.eigenvectors();
  const double determinant = eigenvalues_.prod();
  measure_ = std::sqrt(determinant);
  smoothed_ = std::hypot(measure_, kSmoothing * target_);
  error_[0] = smoothed_ / target_ - std::hypot(1.0, kSmoothing);

  // d det(J J^T) = 2 adj(J J^T) J . dJ
  const auto size = static_cast<Eigen::Index>(rows_.size());
  Diagonal products(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    products[i] = product_without(i, i);
  }
  const Square adjugate = eigenvectors_ * products.asDiagonal() * eigenvectors_.transpose();
  for (const int joint : joints_) {
    for (Eigen::Index i = 0; i < size; ++i) {
      double sum = 0.0;
      for (Eigen::Index j = 0; j < size; ++j) {
        sum += adjugate(i, j) * columns(rows_[static_cast<std::size_t>(j)], joint);
      }
      by_column_(rows_[static_cast<std::size_t>(i)], joint) = 2.0 * sum;
    }
  }
  // joint k turns the columns (v_j, w_j) of itself and those after it by w_k x (...), and shifts the frame along v_k, which
  // adds w_j x v_k to the v_j of those before it
  Vector3 turned = Vector3::Zero();
  for (Eigen::Index k = jacobian_.cols() - 1; k >= 0; --k) {
    const Eigen::Matrix<double, 6, 1> column = columns.col(k);
    const Eigen::Matrix<double, 6, 1> weight = by_column_.col(k);
    turned += column.head<3>().cross(weight.head<3>()) + column.tail<3>().cross(weight.tail<3>());
    jacobian_(0, k) = column.tail<3>().dot(turned);
  }
  Vector3 shifted = Vector3::Zero();
  for (Eigen::Index k = 0; k < jacobian_.cols(); ++k) {
    const Eigen::Matrix<double, 6, 1> column = columns.col(k);
    jacobian_(0, k) += column.head<3>().dot(shifted);
    shifted += by_column_.col(k).head<3>().cross(column.tail<3>());
  }
  jacobian_ /= 2.0 * smoothed_ * target_;
}

void Manipulability::evaluate_drift(const RobotTerms& terms, double /*t*/) {
  const Columns& columns = terms.frame_jacobian(frame_);
  rate_.setZero();
  add_rates(columns, columns, terms.velocity(), rate_);
  acceleration_.setZero();
  add_rates(columns, rate_, terms.velocity(), acceleration_);
  add_rates(rate_, columns, terms.velocity(), acceleration_);

  // d/dt of J J^T, twice, along its eigenvectors
  const Square half_rate = product(rate_, columns);
  const Square half_acceleration = product(acceleration_, columns) + product(rate_, rate_);
  const Square first = eigenvectors_.transpose() * (half_rate + half_rate.transpose()) * eigenvectors_;
  const Square second =
      eigenvectors_.transpose() * (half_acceleration + half_acceleration.transpose()) * eigenvectors_;
  double rate = 0.0;  // of the determinant
  double acceleration = 0.0;
  for (Eigen::Index i = 0; i < eigenvalues_.size(); ++i) {
    const double others = product_without(i, i);
    rate += others * first(i, i);
    acceleration += others * second(i, i);
    for (Eigen::Index j = 0; j < i; ++j) {
      acceleration += 2.0 * product_without(i, j) * (first(i, i) * first(j, j) - first(i, j) * first(i, j));
    }
  }
  drift_[0] = (acceleration - 0.5 * rate * rate / (smoothed_ * smoothed_)) / (2.0 * smoothed_ * target_);
}

}  // namespace tope
