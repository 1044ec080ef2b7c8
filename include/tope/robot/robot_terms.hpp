#pragma once

#include <tope/common/types.hpp>
#include <tope/robot/robot.hpp>

#include <memory>

namespace tope {

/// The robot's kinematic and dynamic terms at one state: the scratch that one controller owns. Never allocates after
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
  /// The same, and with it the terms of the equations of motion (1): mass matrix, bias, drift of every frame.
  void update_dynamics(const VectorArg& q, const VectorArg& v);

  const Vector& position() const;  ///< q of the last update (nq)
  const Vector& velocity() const;  ///< v of the last update (nv)

  /// Placement of a frame in the world.
  Matrix3 frame_rotation(int frame) const;
  Vector3 frame_position(int frame) const;

  /// Jacobian (6 x nv) of a frame: linear velocity of its origin over angular velocity, both along the axes
  /// of the world.
  void frame_jacobian(int frame, Eigen::Ref<Matrix> jacobian) const;
  /// The same without a copy, until the next update() or another frame is asked for.
  const Eigen::Matrix<double, 6, Eigen::Dynamic>& frame_jacobian(int frame) const;

  /// The robot's centre of mass in the world [m] and the Jacobian (3 x nv) of its velocity. Computed when first asked
  /// for after an update; not a number for a robot without mass.
  Vector3 com_position() const;
  const Eigen::Matrix<double, 3, Eigen::Dynamic>& com_jacobian() const;

  /// What follows needs update_dynamics().
  /// H (nv x nv), symmetric, rotor inertia included [kg, kg m, kg m2].
  const Matrix& mass_matrix() const;
  /// h (nv): Coriolis, centrifugal and gravity forces [N or Nm].
  const Vector& bias() const;
  /// Jdot v of a frame (6), in the order and along the axes of frame_jacobian(): the acceleration that it would have if
  /// no joint accelerated.
  Eigen::Matrix<double, 6, 1> frame_drift(int frame) const;
  /// The same for the centre of mass [m/s2].
  Vector3 com_drift() const;

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace tope
