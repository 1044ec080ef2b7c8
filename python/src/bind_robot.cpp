#include "bindings.hpp"

#include <tope/robot/robot.hpp>

namespace nb = nanobind;
using namespace nb::literals;

namespace tope::python {

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
          "position_lower", [](const Robot& robot) -> Vector { return robot.position_lower(); },
          [](Robot& robot, const Vector& lower) { robot.set_position_limits(lower, robot.position_upper()); },
          "Lower position limits (nv) [rad or m]; assign a whole vector to change them.")
      .def_prop_rw(
          "position_upper", [](const Robot& robot) -> Vector { return robot.position_upper(); },
          [](Robot& robot, const Vector& upper) { robot.set_position_limits(robot.position_lower(), upper); },
          "Upper position limits (nv) [rad or m]; assign a whole vector to change them.")
      .def_prop_rw(
          "velocity_limit", [](const Robot& robot) -> Vector { return robot.velocity_limit(); },
          &Robot::set_velocity_limit,
          "Speed bounds (nv) [rad/s or m/s]; assign a whole vector to change them.")
      .def_prop_rw(
          "effort_limit", [](const Robot& robot) -> Vector { return robot.effort_limit(); },
          &Robot::set_effort_limit,
          "Torque or force bounds (nv) [Nm or N]; assign a whole vector to change them.")
      .def("__repr__", [](const Robot& robot) {
        return "tope.Robot('" + robot.name() + "', " + std::to_string(robot.nv()) + " joints)";
      });
}

}  // namespace tope::python
