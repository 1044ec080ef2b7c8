#pragma once

#include <tope/task/task.hpp>

namespace tope {

/// Brings every joint to rest, one row a joint: asks for v = 0, and in torque mode for dv/dt = -gain v. Meant for
/// the lowest level, where it takes what freedom is left. Its error is zero by definition.
class Damping final : public Task {
 public:
  /// The gain [1/s] is for torque mode. Errors: ConfigError unless it is positive and finite.
  explicit Damping(const Robot& robot, double gain = 4.0);

  std::string_view type() const override { return "damping"; }
  std::string_view error_unit() const override { return "mixed"; }
  bool is_goal() const override { return false; }
  bool is_motion() const override { return true; }
  std::unique_ptr<Task> clone() const override { return std::make_unique<Damping>(*this); }

 private:
  void evaluate(const RobotTerms& /*terms*/, double /*t*/) override {}
};

}  // namespace tope
