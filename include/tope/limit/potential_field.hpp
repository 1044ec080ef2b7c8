#pragma once

#include <tope/common/types.hpp>
#include <tope/robot/robot.hpp>

#include <string>
#include <vector>

namespace tope {

struct PotentialFieldOptions {
  std::vector<std::string> joints{};  ///< joints whose limits repel; empty: all that have limits
  double influence = 0.1;             ///< distance from the limit where the field begins [rad or m]
  double strength = 0.05;             ///< speed scale k of the field [rad/s or m/s]
};

/// Repulsive field of joint limits (Khatib 1986): with s = distance / influence, the descent of its potential
/// asks for a speed k (1/s - 1) / s^2 away from the limit, without bound as s vanishes. The gradient is for
/// the null space of the tasks; it keeps no limit by itself.
class PotentialField {
 public:
  /// Errors: ConfigError for an unknown joint, a joint without limits, or an option that is not positive.
  PotentialField(const Robot& robot, const PotentialFieldOptions& options);

  /// Evaluates the field at q (nq). Never allocates.
  void update(const VectorArg& q);

  const Vector& motion() const { return motion_; }  ///< descent direction (n) [rad/s or m/s]
  bool in_range() const { return in_range_; }
  bool repels(int joint) const { return repels_[static_cast<std::size_t>(joint)] != 0; }

 private:
  double repulsion(double distance) const;

  PotentialFieldOptions options_;
  Vector lower_;
  Vector upper_;
  std::vector<char> repels_;
  Vector motion_;
  bool in_range_ = false;
};

}  // namespace tope
