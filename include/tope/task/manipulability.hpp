#pragma once

#include <tope/task/task.hpp>

#include <string>
#include <vector>

namespace tope {

/// What the manipulability of a frame is made of.
struct ManipulabilityOptions {
  /// Rows of the frame's Jacobian that count, along the world's axes: 0 to 2 its origin's, 3 to 5 its rotation's.
  std::vector<int> rows{0, 1, 2, 3, 4, 5};
  /// Joints whose columns count; empty: all. The arm's alone on a mobile base, for example, which moves any point anyhow.
  std::vector<std::string> joints{};
};

/// Brings the manipulability w = sqrt(det(J J^T)) of a frame (Yoshikawa 1985) to a target w_d, along its gradient: one row,
/// e = (sqrt(w^2 + s^2) - sqrt(w_d^2 + s^2)) / w_d with s = w_d / 20, a pure number that is zero at the target and about -1
/// where the frame is singular. So an exponential reference asks for no more than its gain, however small w is, and for
/// less and less on the way to the target. One out of reach climbs as high as higher levels allow; a w beyond it is let
/// down to it.
///
/// s makes e smooth where w is zero: there and nowhere else w has a kink, and no direction leads away from it better than
/// its opposite. The gradient fades below w = s: a robot that starts in a singularity is not led out of it.
/// Gradient and drift are exact, by the first and second derivatives of J, whose columns' cross products they are.
class Manipulability final : public Task {
 public:
  /// The target is in the units of w, the rows' to the power of one each [m^3 for a position]. Errors: ConfigError for an
  /// unknown frame or joint, a target that is not positive, no row or one that is none, or rows of which w is zero in every
  /// state, such as more rows than joints.
  Manipulability(const Robot& robot, const std::string& frame, double target,
                 const ManipulabilityOptions& options = {}, Reference reference = Exponential{});

  std::string_view type() const override { return "manipulability"; }
  std::string_view error_unit() const override { return ""; }
  bool is_goal() const override { return false; }
  std::unique_ptr<Task> clone() const override { return std::make_unique<Manipulability>(*this); }

  double measure() const { return measure_; }  ///< w as of the last update

 private:
  using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  using Diagonal = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

  void evaluate(const RobotTerms& terms, double t) override;
  void evaluate_drift(const RobotTerms& terms, double t) override;
  Square product(const Columns& a, const Columns& b) const;
  double product_without(Eigen::Index i, Eigen::Index j) const;
  void require_measurable(const Robot& robot);

  int frame_;
  double target_;
  std::vector<int> rows_;
  std::vector<int> joints_;
  double measure_ = 0.0;
  double smoothed_ = 0.0;  // sqrt(w^2 + s^2)
  Diagonal eigenvalues_;   // of J J^T
  Square eigenvectors_;
  Columns by_column_;     // d det(J J^T) / d columns of J
  Columns rate_;          // of the frame's columns, as the joints move
  Columns acceleration_;  // likewise, if no joint accelerates
};

}  // namespace tope
