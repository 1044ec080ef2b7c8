#pragma once

#include <tope/reference/target.hpp>
#include <tope/task/task.hpp>

namespace tope {

/// Brings the robot's centre of mass to a point of the world: e = c(q) - c_d [m], 3 rows, along the world's axes, with
/// c = sum m_i c_i / sum m_i over all bodies that joints move. The robot has to be able to move it along all three
/// axes; SelectedRows keeps, for example, the two of the floor: {0, 1}.
class CenterOfMass final : public Task {
 public:
  /// Errors: ConfigError for a robot without mass or a target that is not finite.
  CenterOfMass(const Robot& robot, const Vector3& target, Reference reference = Exponential{});
  CenterOfMass(const Robot& robot, Target<PointTarget> target, Reference reference = Exponential{});

  std::string_view type() const override { return "center_of_mass"; }
  std::string_view error_unit() const override { return "m"; }
  std::unique_ptr<Task> clone() const override { return std::make_unique<CenterOfMass>(*this); }

 private:
  void evaluate(const RobotTerms& terms, double t) override;
  void evaluate_drift(const RobotTerms& terms, double t) override;

  Target<PointTarget> target_;
};

}  // namespace tope
