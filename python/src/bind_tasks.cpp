#include "bindings.hpp"
#include "numbers.hpp"
#include "task_spec.hpp"

#include <tope/common/error.hpp>
#include <tope/task/center_of_mass.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_pose.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_position.hpp>
#include <tope/task/pointing.hpp>
#include <tope/task/posture.hpp>
#include <tope/task/rotation_error.hpp>
#include <tope/task/selected_rows.hpp>

#include <cmath>
#include <utility>

namespace nb = nanobind;
using namespace nb::literals;

namespace tope::python {
namespace {

Vector3 point_at(const nb::handle& target) {
  return numbers_from<Vector3>(target, "target", "a point of three numbers [m]");
}

/// A target that a Python function moves. What it raises inside the control loop must not cross it: the target stands
/// still, and Controller.update raises the error when the cycle is complete.
template <typename Sample>
Target<Sample> moving_target(std::function<Sample(double)> motion) {
  const Sample first = motion(0.0);  // raises here what is wrong from the start
  return Target<Sample>(std::function<Sample(double)>([motion, last = first](double t) mutable {
    if (PyErr_Occurred() != nullptr) {
      return last;
    }
    try {
      last = motion(t);
    } catch (nb::python_error& error) {
      error.restore();
    } catch (const std::exception& error) {
      PyErr_SetString(PyExc_RuntimeError, error.what());
    }
    return last;
  }));
}

/// A point, or a function of time that returns a point and its velocity.
Target<PointTarget> point_from(const nb::object& target) {
  if (PyCallable_Check(target.ptr()) == 0) {
    return PointTarget{.position = point_at(target)};
  }
  return moving_target<PointTarget>([target](double t) {
    const nb::tuple sample = nb::cast<nb::tuple>(target(t));
    return PointTarget{.position = point_at(sample[0]), .velocity = point_at(sample[1])};
  });
}

/// A rotation, or a function of time that returns a rotation and its angular velocity.
Target<RotationTarget> rotating_from(const nb::object& target) {
  if (PyCallable_Check(target.ptr()) == 0) {
    return RotationTarget{.rotation = rotation_from(target, "target")};
  }
  return moving_target<RotationTarget>([target](double t) {
    const nb::tuple sample = nb::cast<nb::tuple>(target(t));
    return RotationTarget{.rotation = rotation_from(sample[0], "target"),
                          .angular_velocity = point_at(sample[1])};
  });
}

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
      "Brings the origin of a frame to a point [m], or to where a function t -> (point, velocity) moves it.");
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
