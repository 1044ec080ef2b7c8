#include "bindings.hpp"

#include <tope/robot/robot.hpp>

#include <nanobind/ndarray.h>

namespace nb = nanobind;
using namespace nb::literals;

namespace tope::python {
namespace {

using Bounds = nb::ndarray<nb::numpy, double, nb::ndim<1>>;

/// A writable view, so that single entries can be set; a controller checks the bounds when it copies the robot.
Bounds view(Robot& robot, const Vector& bounds) {
  auto* data = const_cast<double*>(
      bounds.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast): robot is not const
  return {data, {static_cast<std::size_t>(bounds.size())}, nb::find(robot)};
}

}  // namespace

void bind_robot(nb::module_& module) {
  nb::class_<Robot>(module, "Robot", "A robot of revolute, continuous and prismatic joints, and its bounds.")
      .def_static(
          "from_urdf",
          [](const std::filesystem::path& urdf, const std::optional<std::filesystem::path>& config) {
            return config ? Robot::from_urdf(urdf, *config) : Robot::from_urdf(urdf);
          },
          "urdf"_a, "config"_a = nb::none(), "Reads a URDF and, if given, the robot's YAML file.")
      .def_prop_ro("name", &Robot::name)
      .def_prop_ro("nq", &Robot::nq)
      .def_prop_ro("nv", &Robot::nv)
      .def_prop_ro("joint_names", &Robot::joint_names)
      .def_prop_rw(
          "position_lower", [](Robot& robot) { return view(robot, robot.position_lower()); },
          [](Robot& robot, const Vector& lower) { robot.set_position_limits(lower, robot.position_upper()); },
          "Lower position limits (nv) [rad or m].")
      .def_prop_rw(
          "position_upper", [](Robot& robot) { return view(robot, robot.position_upper()); },
          [](Robot& robot, const Vector& upper) { robot.set_position_limits(robot.position_lower(), upper); },
          "Upper position limits (nv) [rad or m].")
      .def_prop_rw(
          "velocity_limit", [](Robot& robot) { return view(robot, robot.velocity_limit()); },
          &Robot::set_velocity_limit, "Speed bounds (nv) [rad/s or m/s].")
      .def_prop_rw(
          "effort_limit", [](Robot& robot) { return view(robot, robot.effort_limit()); },
          &Robot::set_effort_limit, "Torque or force bounds (nv) [Nm or N].")
      .def("__repr__", [](const Robot& robot) {
        return "tope.Robot('" + robot.name() + "', " + std::to_string(robot.nv()) + " joints)";
      });
}

}  // namespace tope::python
