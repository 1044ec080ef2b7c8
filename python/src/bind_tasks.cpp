#include "bindings.hpp"
#include "task_spec.hpp"

#include <tope/common/error.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_pose.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_position.hpp>
#include <tope/task/posture.hpp>
#include <tope/task/rotation_error.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <utility>

namespace nb = nanobind;
using namespace nb::literals;

namespace tope::python {
namespace {

/// A 3 x 3 matrix, or a quaternion w, x, y, z.
Matrix3 rotation_from(const nb::handle& target) {
  Matrix matrix;
  if (nb::try_cast<Matrix>(target, matrix) && matrix.rows() == 3 && matrix.cols() == 3) {
    return matrix;
  }
  Vector wxyz;
  if (!nb::try_cast<Vector>(target, wxyz) || wxyz.size() != 4) {
    throw ConfigError("target: expected a 3 x 3 rotation matrix or a quaternion (w, x, y, z)");
  }
  if (std::abs(wxyz.norm() - 1.0) > 1e-2) {
    throw ConfigError("target: not a rotation: the norm of the quaternion is " + std::to_string(wxyz.norm()));
  }
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized().toRotationMatrix();
}

/// A point, or a function of time that returns a point and its velocity.
Target<PointTarget> point_from(const nb::object& target) {
  if (PyCallable_Check(target.ptr()) == 0) {
    return PointTarget{.position = nb::cast<Vector3>(target)};
  }
  return Target<PointTarget>(std::function<PointTarget(double)>([target](double t) {
    const auto [position, velocity] = nb::cast<std::pair<Vector3, Vector3>>(target(t));
    return PointTarget{.position = position, .velocity = velocity};
  }));
}

/// A rotation, or a function of time that returns a rotation and its angular velocity.
Target<RotationTarget> rotating_from(const nb::object& target) {
  if (PyCallable_Check(target.ptr()) == 0) {
    return RotationTarget{.rotation = rotation_from(target)};
  }
  return Target<RotationTarget>(std::function<RotationTarget(double)>([target](double t) {
    const nb::tuple sample = nb::cast<nb::tuple>(target(t));
    return RotationTarget{.rotation = rotation_from(sample[0]),
                          .angular_velocity = nb::cast<Vector3>(sample[1])};
  }));
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
          [](PredefinedTime* self, double duration, double gain) {
            new (self) PredefinedTime(PredefinedTime::Options{.duration = duration, .gain = gain});
          },
          "duration"_a, nb::kw_only(), "gain"_a = PredefinedTime::Options{}.gain);
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
      "Posture",
      [](const Vector& target, const Reference& reference) {
        return TaskSpec{"posture", [=](const Robot& robot) {
                          return std::make_unique<Posture>(robot, target, reference);
                        }};
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
