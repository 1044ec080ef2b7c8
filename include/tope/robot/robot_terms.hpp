#pragma once

#include <tope/common/types.hpp>
#include <tope/robot/robot.hpp>

#include <memory>

namespace tope {

/// The robot's kinematic terms at one state: the scratch that one controller owns. Never allocates after
/// construction.
class RobotTerms {
 public:
  explicit RobotTerms(const Robot& robot);
  ~RobotTerms();
  RobotTerms(RobotTerms&&) noexcept;
  RobotTerms& operator=(RobotTerms&&) noexcept;
  RobotTerms(const RobotTerms&) = delete;
  RobotTerms& operator=(const RobotTerms&) = delete;

  /// Forward kinematics and joint Jacobians at q (nq) and v (nv).
  void update(const VectorArg& q, const VectorArg& v);

  const Vector& position() const;  ///< q of the last update (nq)
  const Vector& velocity() const;  ///< v of the last update (nv)

  /// Placement of a frame in the world.
  const Matrix3& frame_rotation(int frame) const;
  const Vector3& frame_position(int frame) const;

  /// Jacobian (6 x nv) of a frame: linear velocity of its origin over angular velocity, both along the axes
  /// of the world.
  void frame_jacobian(int frame, Eigen::Ref<Matrix> jacobian) const;

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace tope
