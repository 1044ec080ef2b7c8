#include "point_distance.hpp"

#include "../common/require_positive.hpp"

#include <coal/internal/intersect.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>
#include <exception>
#include <limits>

namespace tope {
namespace {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

const coal::Sphere& point_shape() {
  static const coal::Sphere point(0.0);
  return point;
}

}  // namespace

PointDistance::PointDistance(const std::string& what, const Shape& shape) {
  std::visit(Overloaded{[&](const shape::Sphere& sphere) {
                          require_positive(what + "radius", sphere.radius);
                          take(std::make_unique<coal::Sphere>(sphere.radius));
                        },
                        [&](const shape::Box& box) {
                          for (const double length : box.size) {
                            require_positive(what + "size", length);
                          }
                          take(std::make_unique<coal::Box>(box.size));
                        },
                        [&](const shape::Capsule& capsule) {
                          require_positive(what + "radius", capsule.radius);
                          require_positive(what + "length", capsule.length);
                          take(std::make_unique<coal::Capsule>(capsule.radius, capsule.length));
                        },
                        [&](const shape::Cylinder& cylinder) {
                          require_positive(what + "radius", cylinder.radius);
                          require_positive(what + "length", cylinder.length);
                          take(std::make_unique<coal::Cylinder>(cylinder.radius, cylinder.length));
                        },
                        [&](const shape::HalfSpace&) {
                          take(std::make_unique<coal::Halfspace>(Vector3::UnitZ(), 0.0));
                        },
                        [&](const shape::ConvexHull& hull) { take_hull(what, hull); }},
             shape);
}

void PointDistance::take(std::unique_ptr<coal::CollisionGeometry> shape) {
  shape_ = std::move(shape);
  distance_.emplace(&point_shape(), shape_.get());
}

void PointDistance::take_hull(const std::string& what, const shape::ConvexHull& hull) {
  auto points = std::make_shared<std::vector<coal::Vec3s>>(hull.points);
  std::unique_ptr<coal::ConvexBase> convex;
  try {
    convex.reset(coal::ConvexBase::convexHull(points, static_cast<unsigned int>(points->size()), true));
  } catch (const std::exception&) {
    throw ConfigError(what + "points: expected at least four that are in no plane, got " +
                      std::to_string(hull.points.size()));
  }
  const auto& surface = dynamic_cast<const coal::Convex<coal::Triangle>&>(*convex);
  const std::vector<coal::Vec3s>& corners = *surface.points;
  for (const coal::Triangle& triangle : *surface.polygons) {
    Face face{.a = corners[triangle[0]],
              .b = corners[triangle[1]],
              .c = corners[triangle[2]],
              .normal = Vector3::Zero()};
    face.normal = (face.b - face.a).cross(face.c - face.a).normalized();
    if (face.normal.dot(face.a - surface.center) < 0.0) {
      face.normal = -face.normal;
    }
    faces_.push_back(face);
  }
}

PointDistance::Result PointDistance::at(const Vector3& point) const {
  if (!distance_) {
    return to_hull(point);
  }
  static const coal::DistanceRequest request;
  const coal::Transform3s shape_frame;
  const coal::Transform3s at_point(point);
  coal::DistanceResult result;
  const double distance = (*distance_)(at_point, shape_frame, request, result);
  return {.distance = distance, .normal = -result.normal};  // coal's points to the shape
}

/// The nearest of the faces that the point is in front of; behind all of them, the one that it is least far behind.
PointDistance::Result PointDistance::to_hull(const Vector3& point) const {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Result outside{.distance = infinite, .normal = Vector3::Zero()};
  Result inside{.distance = -infinite, .normal = Vector3::Zero()};
  for (const Face& face : faces_) {
    const double height = face.normal.dot(point - face.a);
    if (height > inside.distance) {
      inside = {.distance = height, .normal = face.normal};
    }
    if (height <= 0.0) {
      continue;
    }
    const auto foot = coal::Project::projectTriangle(face.a, face.b, face.c, point);
    const double* share = foot.parameterization;
    const Vector3 offset = point - (share[0] * face.a + share[1] * face.b + share[2] * face.c);
    const double distance = offset.norm();
    if (distance < outside.distance) {
      outside = {.distance = distance, .normal = offset / distance};
    }
  }
  return outside.distance < infinite ? outside : inside;
}

}  // namespace tope
