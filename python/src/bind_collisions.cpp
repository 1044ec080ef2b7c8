#include "bindings.hpp"
#include "numbers.hpp"

#include <tope/limit/collision_limits.hpp>

#include <utility>

namespace nb = nanobind;
using namespace nb::literals;

namespace tope::python {
namespace {

using Exclusions = std::vector<std::pair<std::string, std::string>>;

void bind_shapes(nb::module_& module) {
  nb::class_<shape::Sphere>(module, "Sphere", "A ball [m].")
      .def(
          "__init__", [](shape::Sphere* self, double radius) { new (self) shape::Sphere{.radius = radius}; },
          nb::kw_only(), "radius"_a);
  nb::class_<shape::Box>(module, "Box", "A box, with its full lengths along x, y, z [m].")
      .def(
          "__init__",
          [](shape::Box* self, const nb::object& size) {
            new (self) shape::Box{.size = three_numbers(size, "size")};
          },
          nb::kw_only(), "size"_a);
  nb::class_<shape::Capsule>(module, "Capsule", "All within a radius of a segment of a length along z [m].")
      .def(
          "__init__",
          [](shape::Capsule* self, double radius, double length) {
            new (self) shape::Capsule{.radius = radius, .length = length};
          },
          nb::kw_only(), "radius"_a, "length"_a);
  nb::class_<shape::Cylinder>(module, "Cylinder", "A cylinder along z [m].")
      .def(
          "__init__",
          [](shape::Cylinder* self, double radius, double length) {
            new (self) shape::Cylinder{.radius = radius, .length = length};
          },
          nb::kw_only(), "radius"_a, "length"_a);
  nb::class_<shape::HalfSpace>(module, "HalfSpace", "All points with z <= 0: a floor or a wall.")
      .def("__init__", [](shape::HalfSpace* self) { new (self) shape::HalfSpace{}; });
  nb::class_<shape::ConvexHull>(module, "ConvexHull", "The convex hull of points [m].")
      .def(
          "__init__",
          [](shape::ConvexHull* self, const nb::object& points) {
            const auto rows = numbers_from<Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
                points, "points", "rows of three numbers");
            new (self) shape::ConvexHull{};
            for (Eigen::Index i = 0; i < rows.rows(); ++i) {
              self->points.emplace_back(rows.row(i));
            }
          },
          nb::kw_only(), "points"_a)
      .def_static("of_mesh", &shape::ConvexHull::of_mesh, "file"_a,
                  "Of the vertices of a mesh file, in metres.");
}

CollisionGeometry geometry_of(const std::vector<CollisionBody>& obstacles,
                              const std::vector<CollisionSphere>& spheres, const Exclusions& exclude) {
  CollisionGeometry geometry{.spheres = spheres, .bodies = obstacles};
  for (const auto& [sphere, body] : exclude) {
    geometry.exclude.push_back({.sphere = sphere, .body = body});
  }
  return geometry;
}

}  // namespace

void bind_collisions(nb::module_& module) {
  bind_shapes(module);
  nb::class_<CollisionSphere>(module, "CollisionSphere", "A ball that covers part of the robot.")
      .def(
          "__init__",
          [](CollisionSphere* self, const std::string& name, const std::string& frame,
             const nb::object& center, double radius) {
            new (self) CollisionSphere{
                .name = name, .frame = frame, .center = three_numbers(center, "center"), .radius = radius};
          },
          "name"_a, nb::kw_only(), "frame"_a, "center"_a, "radius"_a);
  nb::class_<CollisionBody>(module, "CollisionBody",
                            "A convex body that spheres keep clear of: an obstacle, or a part of the robot.")
      .def(
          "__init__",
          [](CollisionBody* self, const std::string& name, const Shape& shape, const nb::object& position,
             const nb::object& rotation, const std::string& frame) {
            new (self) CollisionBody{.name = name,
                                     .frame = frame,
                                     .shape = shape,
                                     .position = three_numbers(position, "position"),
                                     .rotation = rotation_from(rotation, "rotation")};
          },
          "name"_a, "shape"_a, nb::kw_only(), "position"_a = nb::make_tuple(0.0, 0.0, 0.0),
          "rotation"_a = unit_quaternion(), "frame"_a = "", "Without a frame the world carries it.");
  nb::class_<CollisionOptions>(module, "CollisionOptions", "Distances to keep.")
      .def(
          "__init__",
          [](CollisionOptions* self, const std::vector<CollisionBody>& bodies,
             const std::vector<CollisionSphere>& spheres, const Exclusions& exclude, double margin,
             std::optional<double> gain, std::optional<double> servo_gain) {
            new (self) CollisionOptions{.geometry = geometry_of(bodies, spheres, exclude),
                                        .margin = margin,
                                        .gain = gain,
                                        .servo_gain = servo_gain};
          },
          nb::kw_only(), "bodies"_a = std::vector<CollisionBody>{},
          "spheres"_a = std::vector<CollisionSphere>{}, "exclude"_a = Exclusions{},
          "margin"_a = CollisionOptions{}.margin, "gain"_a = nb::none(), "servo_gain"_a = nb::none(),
          "Beside the robot's own spheres and bodies; `exclude` has (sphere or frame, body) pairs.");
}

}  // namespace tope::python
