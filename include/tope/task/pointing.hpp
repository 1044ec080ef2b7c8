#pragma once

#include <tope/reference/target.hpp>
#include <tope/task/task.hpp>

#include <string>

namespace tope {

/// Points an axis of a frame, through the frame's origin p, at a point x of the world, as a camera is pointed:
/// e = B (d x a) angle / sin(angle) [rad], 2 rows. Along the frame's axes, a is the axis to point, d = R^T (x - p) / |x - p|
/// the direction to the point, angle the one between them, and the rows of B are two unit vectors across a: e is the
/// rotation vector that turns d into a, |e| = angle. Turning about a is free. J has full rank, but
/// - e changes its direction at once where a points straight away from x. near_flip() warns within 0.05 rad of that;
///   within 0.01 rad, d is taken to be 0.01 rad off.
/// - d is undefined where x is the frame's origin; within 1 mm of it, J is that of 1 mm.
class Pointing final : public Task {
 public:
  /// The axis, along the frame's axes, may have any length but zero. Errors: ConfigError for an unknown frame, an axis
  /// of no direction, or a target that is not finite.
  Pointing(const Robot& robot, const std::string& frame, const Vector3& axis, const Vector3& target,
           Reference reference = Exponential{});
  Pointing(const Robot& robot, const std::string& frame, const Vector3& axis, Target<PointTarget> target,
           Reference reference = Exponential{});

  std::string_view type() const override { return "pointing"; }
  std::string_view error_unit() const override { return "rad"; }
  std::unique_ptr<Task> clone() const override { return std::make_unique<Pointing>(*this); }

 private:
  void evaluate(const RobotTerms& terms, double t) override;
  void evaluate_drift(const RobotTerms& terms, double t) override;

  int frame_;
  Vector3 axis_;
  Eigen::Matrix<double, 2, 3> across_;  // d -> B (d x a)
  Target<PointTarget> target_;
};

}  // namespace tope
