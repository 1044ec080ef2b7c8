#include "collision_reader.hpp"

namespace tope {
namespace {

Vector3 positive_lengths(const YamlReader& yaml, const std::string& key) {
  const Vector lengths = yaml.vector(key, 3);
  if (!(lengths.minCoeff() > 0.0)) {
    yaml.fail(key, "lengths must be positive [m]");
  }
  return lengths;
}

Shape read_shape(const YamlReader& yaml) {
  static const std::vector<std::string> types{"sphere",   "box",        "capsule",
                                              "cylinder", "half_space", "convex_hull"};
  switch (choice(yaml, "type", yaml.text("type"), types)) {
    case 0:
      return shape::Sphere{.radius = yaml.positive("radius")};
    case 1:
      return shape::Box{.size = positive_lengths(yaml, "size")};
    case 2:
      return shape::Capsule{.radius = yaml.positive("radius"), .length = yaml.positive("length")};
    case 3:
      return shape::Cylinder{.radius = yaml.positive("radius"), .length = yaml.positive("length")};
    case 4:
      return shape::HalfSpace{};
    default:
      return shape::ConvexHull::of_mesh(yaml.path("mesh"));
  }
}

CollisionSphere read_sphere(const YamlReader& yaml) {
  CollisionSphere sphere{.name = yaml.text("name"),
                         .frame = yaml.text("frame"),
                         .center = yaml.vector("center", 3),
                         .radius = yaml.positive("radius")};
  yaml.finish();
  return sphere;
}

CollisionBody read_body(const YamlReader& yaml) {
  CollisionBody body{.name = yaml.text("name"), .frame = yaml.text("frame", ""), .shape = read_shape(yaml)};
  if (yaml.has("position")) {
    body.position = yaml.vector("position", 3);
  }
  if (yaml.has("quaternion")) {
    body.rotation = yaml.rotation("quaternion");
  }
  yaml.finish();
  return body;
}

}  // namespace

CollisionGeometry read_collision_geometry(const YamlReader& yaml, const std::string& key) {
  CollisionGeometry geometry;
  if (yaml.has("spheres")) {
    for (const YamlReader& item : yaml.list_of_maps("spheres")) {
      geometry.spheres.push_back(read_sphere(item));
    }
  }
  if (yaml.has(key)) {
    for (const YamlReader& item : yaml.list_of_maps(key)) {
      geometry.bodies.push_back(read_body(item));
    }
  }
  if (yaml.has("exclude")) {
    for (const YamlReader& item : yaml.list_of_maps("exclude")) {
      geometry.exclude.push_back({.sphere = item.text("sphere"), .body = item.text("body")});
      item.finish();
    }
  }
  return geometry;
}

}  // namespace tope
