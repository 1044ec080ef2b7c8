#pragma once

#include <tope/task/task.hpp>

namespace tope {

/// Draws the whole robot towards a posture: e = q - target [rad or m], one row a joint. Meant for the lowest
/// level.
class Posture final : public Task {
 public:
  /// Errors: ConfigError when the target (nq) has the wrong size or is not finite.
  Posture(const Robot& robot, const Vector& target, Reference reference = Exponential{});

  std::string_view type() const override { return "posture"; }
  std::string_view error_unit() const override { return "mixed"; }
  bool is_goal() const override { return false; }
  bool is_motion() const override { return true; }
  std::unique_ptr<Task> clone() const override { return std::make_unique<Posture>(*this); }

 private:
  void evaluate(const RobotTerms& terms, double t) override;

  Vector target_;
};

}  // namespace tope
