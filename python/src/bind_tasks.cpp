#include "bindings.hpp"
#include "targets.hpp"
#include "task_spec.hpp"

#include <tope/task/center_of_mass.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_pose.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_group.hpp>
#include <tope/task/joint_position.hpp>
#include <tope/task/manipulability.hpp>
#include <tope/task/pointing.hpp>
#include <tope/task/posture.hpp>
#include <tope/task/relative_pose.hpp>
#include <tope/task/selected_rows.hpp>

#include <utility>

namespace nb = nanobind;
using namespace nb::literals;

namespace tope::python {
namespace {

void bind_references(nb::module_& module) {
  nb::class_<Exponential>(module, "Exponential", "Exponential convergence: rate = -gain error.")
      .def(
          "__init__",
          [](Exponential* self, double gain) { new (self) Exponential(Exponential::Options{.gain = gain}); },
          nb::kw_only(), "gain"_a = Exponential::Options{}.gain);
  nb::class_<PredefinedTime>(module, "PredefinedTime", "Convergence at a stated time after the first update.")
      .def(
          "__init__",
          [](PredefinedTime* self, double duration, double gain, double replan_over) {
            new (self) PredefinedTime(
                PredefinedTime::Options{.duration = duration, .gain = gain, .replan_over = replan_over});
          },
          "duration"_a, nb::kw_only(), "gain"_a = PredefinedTime::Options{}.gain, "replan_over"_a = 0.0,
          "`replan_over` [s]: least time of the plan made anew after something held the task back; 0: none "
          "is made.");
}

}  // namespace

void bind_tasks(nb::module_& module) {
  bind_references(module);
  nb::class_<TaskSpec>(module, "Task", "A goal; a controller makes it its own.")
      .def("__repr__", [](const TaskSpec& spec) { return "tope task of type " + spec.type; });

  module.def(
      "FramePosition",
      [](const std::string& frame, const nb::object& target, const Reference& reference) {
        return TaskSpec{"frame_position", [=, point = point_from(target)](const Robot& robot) {
                          return std::make_unique<FramePosition>(robot, frame, point, reference);
                        }};
      },
      nb::kw_only(), "frame"_a, "target"_a, "reference"_a = Exponential{},
      "Brings the origin of a frame to a point [m], or to where a PointPath, a PointStream or a function t "
      "-> (point, "
      "velocity) "
      "moves it.");
  module.def(
      "FrameOrientation",
      [](const std::string& frame, const nb::object& target, const Reference& reference) {
        return TaskSpec{"frame_orientation", [=, rotation = rotating_from(target)](const Robot& robot) {
                          return std::make_unique<FrameOrientation>(robot, frame, rotation, reference);
                        }};
      },
      nb::kw_only(), "frame"_a, "target"_a, "reference"_a = Exponential{},
      "Turns a frame as a 3 x 3 matrix or a quaternion (w, x, y, z) says, or as a function t -> (rotation, "
      "angular "
      "velocity) turns.");
  module.def(
      "FramePose",
      [](const std::string& frame, const nb::object& position, const nb::object& rotation,
         const Reference& reference) {
        return TaskSpec{"frame_pose", [=, point = point_from(position),
                                       turned = rotating_from(rotation)](const Robot& robot) {
                          return std::make_unique<FramePose>(robot, frame, point, turned, reference);
                        }};
      },
      nb::kw_only(), "frame"_a, "position"_a, "rotation"_a, "reference"_a = Exponential{},
      "Position and orientation of a frame as one task of six rows.");
  module.def(
      "Pointing",
      [](const std::string& frame, const nb::object& axis, const nb::object& target,
         const Reference& reference) {
        return TaskSpec{"pointing", [=, direction = numbers_from<Vector3>(axis, "axis", "three numbers"),
                                     point = point_from(target)](const Robot& robot) {
                          return std::make_unique<Pointing>(robot, frame, direction, point, reference);
                        }};
      },
      nb::kw_only(), "frame"_a, "axis"_a, "target"_a, "reference"_a = Exponential{},
      "Points an axis of a frame, given along the frame's axes, at a point [m], or at where a function t -> "
      "(point, velocity) moves it.");
  module.def(
      "CenterOfMass",
      [](const nb::object& target, const Reference& reference) {
        return TaskSpec{"center_of_mass", [=, point = point_from(target)](const Robot& robot) {
                          return std::make_unique<CenterOfMass>(robot, point, reference);
                        }};
      },
      nb::kw_only(), "target"_a, "reference"_a = Exponential{},
      "Brings the robot's centre of mass to a point [m], or to where a function t -> (point, velocity) moves "
      "it.");
  module.def(
      "RelativePose",
      [](const std::string& frame, const std::string& seen_from, const nb::object& position,
         const nb::object& rotation, const Reference& reference) {
        RelativeTarget target;
        if (!position.is_none()) {
          target.position = point_from(position);
        }
        if (!rotation.is_none()) {
          target.rotation = rotating_from(rotation);
        }
        return TaskSpec{"relative_pose", [=](const Robot& robot) {
                          return std::make_unique<RelativePose>(robot, frame, seen_from, target, reference);
                        }};
      },
      nb::kw_only(), "frame"_a, "seen_from"_a, "position"_a = nb::none(), "rotation"_a = nb::none(),
      "reference"_a = Exponential{},
      "Position, rotation or both of a frame as another frame of the robot sees it, along that one's axes.");
  module.def(
      "Manipulability",
      [](const std::string& frame, double target, const std::vector<int>& rows,
         const std::vector<std::string>& joints, const Reference& reference) {
        return TaskSpec{"manipulability", [=](const Robot& robot) {
                          return std::make_unique<Manipulability>(
                              robot, frame, target, ManipulabilityOptions{.rows = rows, .joints = joints},
                              reference);
                        }};
      },
      nb::kw_only(), "frame"_a, "target"_a, "rows"_a = ManipulabilityOptions{}.rows,
      "joints"_a = std::vector<std::string>{}, "reference"_a = Exponential{},
      "Brings the manipulability sqrt(det(J J^T)) of a frame to a target; of some rows of its Jacobian (0 to "
      "2: "
      "position, 3 to 5: rotation) and of some joints' columns, if named.");
  module.def(
      "JointGroup",
      [](const TaskSpec& task, const std::vector<std::string>& joints) {
        return TaskSpec{task.type, [=](const Robot& robot) {
                          return std::make_unique<JointGroup>(robot, *task.make(robot), joints);
                        }};
      },
      "task"_a, nb::kw_only(), "joints"_a,
      "A task served by some joints alone. What the others do disturbs it; feedback alone answers that.");
  module.def(
      "SelectedRows",
      [](const TaskSpec& task, const std::vector<int>& rows) {
        return TaskSpec{task.type, [=](const Robot& robot) {
                          return std::make_unique<SelectedRows>(*task.make(robot), rows);
                        }};
      },
      "task"_a, nb::kw_only(), "rows"_a,
      "A task with some of its rows alone, counted from 0: 2 is the height of a position.");
  module.def(
      "Posture",
      [](const nb::object& target, const Reference& reference) {
        return TaskSpec{
            "posture",
            [=, posture = numbers_from<Vector>(target, "target", "a list of joint positions")](
                const Robot& robot) { return std::make_unique<Posture>(robot, posture, reference); }};
      },
      nb::kw_only(), "target"_a, "reference"_a = Exponential{}, "Draws all joints towards a posture (nq).");
  module.def(
      "JointPosition",
      [](const std::map<std::string, double>& target, const Reference& reference) {
        return TaskSpec{"joint_position", [=](const Robot& robot) {
                          return std::make_unique<JointPosition>(
                              robot,
                              std::vector<std::pair<std::string, double>>(target.begin(), target.end()),
                              reference);
                        }};
      },
      nb::kw_only(), "target"_a, "reference"_a = Exponential{}, "Brings named joints to given positions.");
  module.def(
      "Damping",
      [] { return TaskSpec{"damping", [](const Robot& robot) { return std::make_unique<Damping>(robot); }}; },
      "Brings every joint to rest, as far as higher levels leave it free.");
}

}  // namespace tope::python
