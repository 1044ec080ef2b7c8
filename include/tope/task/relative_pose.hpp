#pragma once

#include <tope/reference/target.hpp>
#include <tope/task/task.hpp>

#include <optional>
#include <string>

namespace tope {

/// Where one frame is to be as another sees it; what is left out is free. Along the axes of the frame that looks on.
struct RelativeTarget {
  std::optional<Target<PointTarget>> position{};
  std::optional<Target<RotationTarget>> rotation{};
};

/// Brings a frame B to a pose as seen from another frame A of the same robot, which may move too: one hand in the other, a
/// tool against the base. With p = R_A^T (p_B - p_A) and R = R_A^T R_B, the error is e = p - p_d [m] over
/// e = log(R_d^T R) [rad]: 6 rows along A's axes, or the 3 of what the target names. All joints between the two serve it;
/// those that move both alike have no part. The rotation's direction flips where its angle reaches pi, as in
/// FrameOrientation.
class RelativePose final : public Task {
 public:
  /// Errors: ConfigError for an unknown frame, two frames that no joint moves against each other, a target that names
  /// nothing, is not finite or no rotation.
  RelativePose(const Robot& robot, const std::string& frame, const std::string& seen_from,
               RelativeTarget target, Reference reference = Exponential{});

  std::string_view type() const override { return "relative_pose"; }
  std::string_view error_unit() const override;
  std::unique_ptr<Task> clone() const override { return std::make_unique<RelativePose>(*this); }

 private:
  void evaluate(const RobotTerms& terms, double t) override;
  void evaluate_drift(const RobotTerms& terms, double t) override;
  void find_relative_motion(const RobotTerms& terms);
  void require_moving(const Robot& robot);

  int frame_;
  int seen_from_;
  RelativeTarget target_;
  Vector3 offset_;                                              // p_B - p_A, along the world's axes
  Vector3 position_;                                            // p
  Matrix3 rotation_;                                            // R
  Eigen::Matrix<double, 6, Eigen::Dynamic> relative_jacobian_;  // of p and R, along A's axes (6 x nv)
};

}  // namespace tope
