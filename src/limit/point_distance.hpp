#pragma once

#include <tope/robot/collision_geometry.hpp>

#include <coal/distance.h>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tope {

/// Signed distance from a point to a convex shape, by coal's closed forms; a convex hull is the triangles of its surface,
/// as coal's iterative method allocates with every query. Outside, the distance is continuously differentiable.
class PointDistance {
 public:
  /// Errors: ConfigError, beginning with `what`, for a size that is not positive or a hull without volume.
  PointDistance(const std::string& what, const Shape& shape);

  struct Result {
    double distance;  ///< negative inside [m]
    Vector3 normal;   ///< its gradient: unit vector from the shape to the point
  };
  /// For a point in the shape's frame [m]. Never allocates.
  Result at(const Vector3& point) const;

 private:
  struct Face {
    Vector3 a;
    Vector3 b;
    Vector3 c;
    Vector3 normal;  // outward
  };

  void take(std::unique_ptr<coal::CollisionGeometry> shape);
  void take_hull(const std::string& what, const shape::ConvexHull& hull);
  Result to_hull(const Vector3& point) const;

  std::unique_ptr<coal::CollisionGeometry> shape_;  // none for a hull
  std::optional<coal::ComputeDistance> distance_;   // from a point to it
  std::vector<Face> faces_;                         // of a hull
};

}  // namespace tope
