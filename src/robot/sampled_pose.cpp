#include <tope/robot/sampled_pose.hpp>

#include <cmath>
#include <numbers>

namespace tope {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;  // looked at where a joint has no limit [rad or m]

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

}  // namespace

Vector sampled_pose(const Robot& robot, int k) {
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

}  // namespace tope
