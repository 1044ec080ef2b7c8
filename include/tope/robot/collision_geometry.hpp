#pragma once

#include <tope/common/types.hpp>

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace tope {

/// Convex shapes, each in a frame of its own [m].
namespace shape {
struct Sphere {
  double radius;
};
struct Box {
  Vector3 size;  ///< full lengths along x, y, z
};
struct Capsule {
  double radius;
  double length;  ///< between the centres of its ends, along z
};
struct Cylinder {
  double radius;
  double length;  ///< along z
};
struct HalfSpace {};  ///< all points with z <= 0: a floor or a wall
struct ConvexHull {
  std::vector<Vector3> points;

  /// Of the vertices of a mesh file (STL, OBJ, DAE ...), in metres. Errors: ConfigError when it cannot be read.
  static ConvexHull of_mesh(const std::filesystem::path& file);
};
}  // namespace shape

using Shape = std::variant<shape::Sphere, shape::Box, shape::Capsule, shape::Cylinder, shape::HalfSpace,
                           shape::ConvexHull>;

/// A ball that covers part of the robot.
struct CollisionSphere {
  std::string name;
  std::string frame;  ///< of the robot, that it is fixed to
  Vector3 center;     ///< in that frame [m]
  double radius;      ///< [m]
};

/// A convex body that spheres keep clear of: an obstacle, or a part of the robot.
struct CollisionBody {
  std::string name;
  std::string frame{};  ///< of the robot, that it is fixed to; empty: the world
  Shape shape;
  Vector3 position = Vector3::Zero();      ///< of the shape's frame in `frame` [m]
  Matrix3 rotation = Matrix3::Identity();  ///< of the shape's frame in `frame`
};

/// Names a sphere, or a frame for all spheres on it, and a body whose distance does not matter.
struct CollisionExclusion {
  std::string sphere;
  std::string body;
};

struct CollisionGeometry {
  std::vector<CollisionSphere> spheres{};
  std::vector<CollisionBody> bodies{};
  std::vector<CollisionExclusion> exclude{};
};

}  // namespace tope
