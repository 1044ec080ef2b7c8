#include "../common/require_positive.hpp"
#include "../common/rotation_check.hpp"
#include "point_distance.hpp"

#include <tope/common/names.hpp>
#include <tope/limit/collision_limits.hpp>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

using Twist = Eigen::Matrix<double, 6, 1>;  // linear over angular
using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using FrameJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// What is fixed to a frame moves a point at `arm` from its origin.
Vector3 velocity_at(const Twist& twist, const Vector3& arm) {
  return twist.head<3>() + twist.tail<3>().cross(arm);
}

Vector3 acceleration_at(const Twist& twist, const Twist& acceleration, const Vector3& arm) {
  const Vector3 omega = twist.tail<3>();
  return acceleration.head<3>() + acceleration.tail<3>().cross(arm) + omega.cross(omega.cross(arm));
}

template <typename Item>
void append(std::vector<Item>& items, const std::vector<Item>& more) {
  items.insert(items.end(), more.begin(), more.end());
}

CollisionGeometry joined(CollisionGeometry geometry, const CollisionGeometry& more) {
  append(geometry.spheres, more.spheres);
  append(geometry.bodies, more.bodies);
  append(geometry.exclude, more.exclude);
  return geometry;
}

template <typename Items>
std::vector<std::string> unique_names(const Items& items, const std::string& what) {
  std::vector<std::string> names;
  for (const auto& item : items) {
    if (std::find(names.begin(), names.end(), item.name) != names.end()) {
      throw ConfigError("collisions: a second " + what + " is named '" + item.name + "'");
    }
    names.push_back(item.name);
  }
  if (names.empty()) {
    throw ConfigError("collisions: no " + what + " is given, by the robot or otherwise");
  }
  return names;
}

int frame_of(const Robot& robot, const std::string& what, const std::string& frame) {
  try {
    return robot.frame_index(frame);
  } catch (const ConfigError& error) {
    throw ConfigError("collisions: " + what + ": " + error.what());
  }
}

bool concerns(const CollisionExclusion& exclusion, const CollisionSphere& sphere) {
  return exclusion.sphere == sphere.name || exclusion.sphere == sphere.frame;
}

bool excluded(const CollisionGeometry& geometry, const CollisionSphere& sphere, const CollisionBody& body) {
  return std::any_of(geometry.exclude.begin(), geometry.exclude.end(), [&](const auto& exclusion) {
    return exclusion.body == body.name && concerns(exclusion, sphere);
  });
}

}  // namespace

struct CollisionLimits::Geometry {
  struct Ball {
    int frame;
    Vector3 center;  // in the frame
    double radius;
    Vector3 position = Vector3::Zero();  // in the world
    PointJacobian jacobian;
    Vector3 velocity = Vector3::Zero();
    Vector3 drift = Vector3::Zero();  // acceleration at fixed joint velocities

    void locate(const RobotTerms& terms) {
      const Vector3 arm = terms.frame_rotation(frame) * center;
      const FrameJacobian& frame_jacobian = terms.frame_jacobian(frame);
      position = terms.frame_position(frame) + arm;
      for (Eigen::Index j = 0; j < jacobian.cols(); ++j) {
        jacobian.col(j) = velocity_at(frame_jacobian.col(j), arm);
      }
    }
    void move(const RobotTerms& terms) {
      const Vector3 arm = position - terms.frame_position(frame);
      const Twist twist = terms.frame_jacobian(frame) * terms.velocity();
      velocity = velocity_at(twist, arm);
      drift = acceleration_at(twist, terms.frame_drift(frame), arm);
    }
  };

  struct Body {
    int frame;  // -1: the world
    PointDistance shape;
    Vector3 local_position;
    Matrix3 local_rotation;
    Vector3 origin = Vector3::Zero();    // of what carries it, in the world
    Vector3 position = Vector3::Zero();  // of the shape
    Matrix3 rotation = Matrix3::Identity();
    FrameJacobian jacobian;       // of the frame; zero in the world
    Twist twist = Twist::Zero();  // of the frame, or of an obstacle
    Twist drift = Twist::Zero();

    bool in_world() const { return frame < 0; }
    void locate(const RobotTerms& terms) {
      if (in_world()) {
        origin = position = local_position;
        rotation = local_rotation;
        return;
      }
      const Matrix3 frame_rotation = terms.frame_rotation(frame);
      origin = terms.frame_position(frame);
      position = origin + frame_rotation * local_position;
      rotation = frame_rotation * local_rotation;
      jacobian = terms.frame_jacobian(frame);
    }
    void move(const RobotTerms& terms) {
      if (!in_world()) {
        twist.noalias() = jacobian * terms.velocity();
        drift = terms.frame_drift(frame);
      }
    }
    PointDistance::Result distance(const Vector3& point) const {
      PointDistance::Result result = shape.at(rotation.transpose() * (point - position));
      result.normal = rotation * result.normal;
      return result;
    }
  };

  struct Pair {
    std::size_t ball;
    std::size_t body;
    Vector3 normal = Vector3::Zero();
    Vector3 drift = Vector3::Zero();
  };

  std::vector<Ball> balls;
  std::vector<Body> bodies;
  std::vector<std::string> body_names;
  std::vector<Pair> pairs;
};

CollisionLimits::CollisionLimits(const Robot& robot, const CollisionOptions& options, double joint_gain,
                                 double joint_servo_gain)
    : margin_(options.margin),
      gain_(options.gain.value_or(joint_gain)),
      servo_gain_(options.servo_gain.value_or(joint_servo_gain)),
      geometry_(std::make_unique<Geometry>()) {
  require_positive("collisions: margin", margin_);
  require_positive("collisions: gain", gain_);
  require_positive("collisions: servo_gain", servo_gain_);
  const CollisionGeometry given = joined(robot.collisions(), options.geometry);
  const std::vector<std::string> sphere_names = unique_names(given.spheres, "sphere");
  geometry_->body_names = unique_names(given.bodies, "body");
  add_spheres(robot, given.spheres);
  add_bodies(robot, given.bodies);
  for (const CollisionExclusion& exclusion : given.exclude) {
    body_index(exclusion.body);
    if (std::none_of(given.spheres.begin(), given.spheres.end(),
                     [&](const auto& sphere) { return concerns(exclusion, sphere); })) {
      throw ConfigError("collisions: exclude: unknown sphere or frame '" + exclusion.sphere + "'" +
                        name_hint(exclusion.sphere, sphere_names));
    }
  }
  add_pairs(robot, given);
  const auto pairs = static_cast<Eigen::Index>(names_.size());
  distance_ = Vector::Zero(pairs);
  jacobian_ = Matrix::Zero(pairs, robot.nv());
  motion_lower_ = Vector::Zero(pairs);
}

CollisionLimits::~CollisionLimits() = default;
CollisionLimits::CollisionLimits(CollisionLimits&&) noexcept = default;
CollisionLimits& CollisionLimits::operator=(CollisionLimits&&) noexcept = default;

void CollisionLimits::add_spheres(const Robot& robot, const std::vector<CollisionSphere>& spheres) {
  for (const CollisionSphere& sphere : spheres) {
    const std::string what = "sphere " + sphere.name;
    require_positive("collisions: " + what + ": radius", sphere.radius);
    if (!sphere.center.allFinite()) {
      throw ConfigError("collisions: " + what + ": its center must be finite");
    }
    geometry_->balls.push_back({.frame = frame_of(robot, what, sphere.frame),
                                .center = sphere.center,
                                .radius = sphere.radius,
                                .jacobian = PointJacobian::Zero(3, robot.nv())});
  }
}

void CollisionLimits::add_bodies(const Robot& robot, const std::vector<CollisionBody>& bodies) {
  for (const CollisionBody& body : bodies) {
    const std::string what = "body " + body.name;
    if (!body.position.allFinite() || !is_rotation(body.rotation)) {
      throw ConfigError("collisions: " + what + ": its position must be finite, its rotation orthonormal");
    }
    geometry_->bodies.push_back({.frame = body.frame.empty() ? -1 : frame_of(robot, what, body.frame),
                                 .shape = PointDistance("collisions: " + what + ": ", body.shape),
                                 .local_position = body.position,
                                 .local_rotation = body.rotation,
                                 .jacobian = FrameJacobian::Zero(6, robot.nv())});
  }
}

void CollisionLimits::add_pairs(const Robot& robot, const CollisionGeometry& given) {
  for (std::size_t i = 0; i < given.spheres.size(); ++i) {
    for (std::size_t k = 0; k < given.bodies.size(); ++k) {
      const int frame = geometry_->balls[i].frame;
      const Geometry::Body& body = geometry_->bodies[k];
      const bool near = body.in_world() ? robot.fixed_in_world(frame) : robot.neighbours(frame, body.frame);
      if (!near && !excluded(given, given.spheres[i], given.bodies[k])) {
        geometry_->pairs.push_back({.ball = i, .body = k});
        names_.push_back(given.spheres[i].name + "." + given.bodies[k].name);
      }
    }
  }
  if (names_.empty()) {
    throw ConfigError("collisions: every sphere is next to every body or excluded: no distance is left");
  }
}

int CollisionLimits::body_index(const std::string& name) const {
  const std::vector<std::string>& names = geometry_->body_names;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw ConfigError("collisions: unknown body '" + name + "'" + name_hint(name, names));
  }
  return static_cast<int>(found - names.begin());
}

bool CollisionLimits::move(int body, const BodyMotion& motion) noexcept {
  if (body < 0 || body >= static_cast<int>(geometry_->bodies.size())) {
    return false;
  }
  Geometry::Body& moved = geometry_->bodies[static_cast<std::size_t>(body)];
  if (!moved.in_world() || !motion.position.allFinite() || !motion.velocity.allFinite() ||
      !motion.angular_velocity.allFinite() || !is_rotation(motion.rotation)) {
    return false;
  }
  moved.local_position = motion.position;
  moved.local_rotation = motion.rotation;
  moved.twist << motion.velocity, motion.angular_velocity;
  return true;
}

/// Distances, normals and c.
void CollisionLimits::locate(const RobotTerms& terms) {
  for (Geometry::Ball& ball : geometry_->balls) {
    ball.locate(terms);
  }
  for (Geometry::Body& body : geometry_->bodies) {
    body.locate(terms);
  }
  for (std::size_t i = 0; i < geometry_->pairs.size(); ++i) {
    Geometry::Pair& pair = geometry_->pairs[i];
    const Geometry::Ball& ball = geometry_->balls[pair.ball];
    const Geometry::Body& body = geometry_->bodies[pair.body];
    const PointDistance::Result nearest = body.distance(ball.position);
    const auto row = static_cast<Eigen::Index>(i);
    pair.normal = nearest.normal;
    distance_[row] = nearest.distance - ball.radius;
    jacobian_.row(row).noalias() = pair.normal.transpose() * ball.jacobian;
    if (!body.in_world()) {
      const Vector3 moment = (ball.position - body.origin).cross(pair.normal);
      jacobian_.row(row).noalias() -= pair.normal.transpose() * body.jacobian.topRows<3>();
      jacobian_.row(row).noalias() -= moment.transpose() * body.jacobian.bottomRows<3>();
    }
  }
}

void CollisionLimits::update(const RobotTerms& terms) {
  locate(terms);
  motion_lower_ = -gain_ * (distance_.array() - margin_);
  for (std::size_t i = 0; i < geometry_->pairs.size(); ++i) {
    const Geometry::Pair& pair = geometry_->pairs[i];
    const Geometry::Body& body = geometry_->bodies[pair.body];
    if (body.in_world()) {
      const Vector3 arm = geometry_->balls[pair.ball].position - body.origin;
      motion_lower_[static_cast<Eigen::Index>(i)] += pair.normal.dot(velocity_at(body.twist, arm));
    }
  }
}

void CollisionLimits::update_second_order(const RobotTerms& terms) {
  locate(terms);
  for (Geometry::Ball& ball : geometry_->balls) {
    ball.move(terms);
  }
  for (Geometry::Body& body : geometry_->bodies) {
    body.move(terms);
  }
  for (std::size_t i = 0; i < geometry_->pairs.size(); ++i) {
    Geometry::Pair& pair = geometry_->pairs[i];
    const Geometry::Ball& ball = geometry_->balls[pair.ball];
    const Geometry::Body& body = geometry_->bodies[pair.body];
    const Vector3 arm = ball.position - body.origin;
    const Vector3 relative = ball.velocity - velocity_at(body.twist, arm);
    const Vector3 omega = body.twist.tail<3>();
    pair.drift = ball.drift - acceleration_at(body.twist, body.drift, arm) - 2.0 * omega.cross(relative);
    const auto row = static_cast<Eigen::Index>(i);
    motion_lower_[row] = -(gain_ + servo_gain_) * pair.normal.dot(relative) -
                         gain_ * servo_gain_ * (distance_[row] - margin_) - pair.normal.dot(pair.drift);
  }
}

int CollisionLimits::pressed_by(const VectorArg& motion, double slack) const {
  int pressed = -1;
  for (int i = 0; i < size(); ++i) {
    const double room = jacobian_.row(i).dot(motion) - motion_lower_[i];
    if (room < slack) {
      slack = room;
      pressed = i;
    }
  }
  return pressed;
}

double CollisionLimits::drift() const {
  double largest = 0.0;
  for (const Geometry::Pair& pair : geometry_->pairs) {
    largest = std::max(largest, pair.drift.norm());
  }
  return largest;
}

int CollisionLimits::inside() const {
  Eigen::Index nearest = 0;
  return distance_.minCoeff(&nearest) < margin_ ? static_cast<int>(nearest) : -1;
}

}  // namespace tope
