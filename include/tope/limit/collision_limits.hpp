#pragma once

#include <tope/common/types.hpp>
#include <tope/robot/robot.hpp>
#include <tope/robot/robot_terms.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tope {

struct CollisionOptions {
  CollisionGeometry geometry{};  ///< beside the robot's own: obstacles are bodies fixed in the world
  double margin = 0.01;          ///< m: distance kept between each sphere and each body [m]
  /// lambda, gamma_1: approach speed allowed per distance [1/s]. Unset: that of the joint limits. In torque mode more than
  /// that could ask the drives for more than they have.
  std::optional<double> gain{};
  /// gamma_2: how fast the approach returns below what is allowed, torque mode [1/s]. Unset: that of the joint limits.
  std::optional<double> servo_gain{};
};

/// Where a body that is fixed to no frame is at one moment, and how it moves.
struct BodyMotion {
  Vector3 position;                            ///< of the shape's frame [m]
  Matrix3 rotation = Matrix3::Identity();      ///< of the shape's frame
  Vector3 velocity = Vector3::Zero();          ///< of its origin [m/s]
  Vector3 angular_velocity = Vector3::Zero();  ///< [rad/s]
};

/// Rows that keep the robot's spheres clear of bodies: obstacles, and its own links. One row for each pair of a sphere and
/// a body, except for those that are fixed to each other, to links that one joint connects, or excluded by name.
///
/// The distance of a pair is that of the sphere's centre x to the body, less the radius. The body is convex, so outside
/// of it the distance is continuously differentiable, with the unit vector n from the body to x as its gradient:
///   d/dt d = n^T (v_x - v_body(x)) = c qdot - n^T v_obstacle(x),  c = n^T (J_x - J_body(x))
/// with v_body(x) the velocity that x would have if it were fixed to the body.
///
/// Velocity mode, update():                c qdot  >= -gain (d - margin) + n^T v_obstacle(x)
/// Torque mode, update_second_order(): with the envelope V = gain (d - margin) of the approach speed,
///                                         c qddot >= -(gain + servo_gain) d/dt d - gain servo_gain (d - margin) - drift
///   drift = n^T (a_x - a_body(x) - 2 omega x v_rel), the accelerations of fixed joint velocities. The term of the
///   shape's curvature, v_rel^T (d2 d / dx2) v_rel >= 0, is left out on the safe side: it jumps at a shape's edges.
class CollisionLimits {
 public:
  /// `joint_gain` and `joint_servo_gain` [1/s] are those of the joint limits. Errors: ConfigError for a name that is unknown
  /// or given twice, a size that is not positive, no sphere, no body, or no pair of the two.
  CollisionLimits(const Robot& robot, const CollisionOptions& options, double joint_gain,
                  double joint_servo_gain);
  ~CollisionLimits();
  CollisionLimits(CollisionLimits&&) noexcept;
  CollisionLimits& operator=(CollisionLimits&&) noexcept;
  CollisionLimits(const CollisionLimits&) = delete;
  CollisionLimits& operator=(const CollisionLimits&) = delete;

  /// Number of a body, for move(). Errors: ConfigError for an unknown name, with the nearest known one.
  int body_index(const std::string& name) const;
  /// Moves a body that is fixed to no frame from the next update on. Never allocates. False, and nothing changes, for
  /// another body, what is not finite, or a matrix that is no rotation.
  [[nodiscard]] bool move(int body, const BodyMotion& motion) noexcept;

  /// Evaluates every row at the terms' state. Never allocates.
  void update(const RobotTerms& terms);
  /// The same for torque mode: motions are accelerations. The terms need update_dynamics().
  void update_second_order(const RobotTerms& terms);

  int size() const { return static_cast<int>(distance_.size()); }   ///< p
  const std::vector<std::string>& names() const { return names_; }  ///< "sphere.body" of each pair
  const Vector& distance() const { return distance_; }              ///< (p) [m]
  const Matrix& jacobian() const { return jacobian_; }              ///< c of each pair (p x nv)
  const Vector& motion_lower() const { return motion_lower_; }      ///< (p) [m/s or m/s2]
  double margin() const { return margin_; }                         ///< [m]
  double gain() const { return gain_; }                             ///< [1/s]
  /// Largest acceleration of a sphere relative to a body while the joints' velocities stay as they are, as of
  /// update_second_order() [m/s2]: how far a distance can bend from its tangent.
  double drift() const;
  double servo_gain() const { return servo_gain_; }  ///< [1/s]
  /// Pair that a motion (nv) presses hardest, of those whose bounds are nearer than `slack` [m/s or m/s2]; -1: none.
  int pressed_by(const VectorArg& motion, double slack) const;
  /// Pair furthest inside its margin, or -1.
  int inside() const;

 private:
  struct Geometry;

  void add_spheres(const Robot& robot, const std::vector<CollisionSphere>& spheres);
  void add_bodies(const Robot& robot, const std::vector<CollisionBody>& bodies);
  void add_pairs(const Robot& robot, const CollisionGeometry& given);
  void locate(const RobotTerms& terms);

  double margin_;
  double gain_;
  double servo_gain_;
  std::unique_ptr<Geometry> geometry_;
  std::vector<std::string> names_;
  Vector distance_;
  Matrix jacobian_;
  Vector motion_lower_;
};

}  // namespace tope
