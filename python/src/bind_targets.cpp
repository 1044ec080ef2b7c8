#include "targets.hpp"

#include <tope/reference/target_stream.hpp>
#include <tope/reference/waypoints.hpp>

#include <functional>
#include <vector>

namespace nb = nanobind;
using namespace nb::literals;

namespace tope::python {
namespace {

Vector3 point_at(const nb::handle& target) {
  return numbers_from<Vector3>(target, "target", "a point of three numbers [m]");
}

/// A target that a Python function moves; the control loop calls it and waits for it. What it raises inside the control loop must not cross it: the target stands
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

/// Waypoints from times and as many values, each read by `read`.
template <typename Waypoint, typename Read>
std::vector<Waypoint> waypoints_from(const std::vector<double>& times, const nb::sequence& values,
                                     Read read) {
  if (times.size() != nb::len(values)) {
    throw ConfigError("expected as many times as waypoints, got " + std::to_string(times.size()) + " and " +
                      std::to_string(nb::len(values)));
  }
  std::vector<Waypoint> waypoints;
  waypoints.reserve(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    waypoints.push_back({times[i], read(values[i])});
  }
  return waypoints;
}

void bind_streams(nb::module_& module) {
  const StreamOptions usual;
  nb::class_<PointStream>(
      module, "PointStream",
      "A target that comes in samples from outside the control loop, from another thread for example. "
      "It goes on with a sample's velocity for up to `hold` seconds, then stops; a filter with a triple "
      "pole at -`rate` [1/s] makes it smooth.")
      .def(
          "__init__",
          [](PointStream* self, const nb::object& start, double rate, double hold) {
            new (self) PointStream(point_at(start), StreamOptions{.rate = rate, .hold = hold});
          },
          "start"_a, nb::kw_only(), "rate"_a = usual.rate, "hold"_a = usual.hold,
          "Rests at `start` [m] until the first sample.")
      .def(
          "put",
          [](PointStream& self, double time, const nb::object& position, const nb::object& velocity) {
            return self.put({.time = time, .position = point_at(position), .velocity = point_at(velocity)});
          },
          "time"_a, "position"_a, "velocity"_a = nb::make_tuple(0.0, 0.0, 0.0),
          "A sample of that time [s, on the clock of Controller.update], position [m] and velocity [m/s]. "
          "False, and "
          "nothing changes, for what is not finite or no later than the one before.");
  nb::class_<RotationStream>(module, "RotationStream",
                             "The same as PointStream for a rotation, a matrix or a quaternion (w, x, y, z).")
      .def(
          "__init__",
          [](RotationStream* self, const nb::object& start, double rate, double hold) {
            new (self)
                RotationStream(rotation_from(start, "target"), StreamOptions{.rate = rate, .hold = hold});
          },
          "start"_a, nb::kw_only(), "rate"_a = usual.rate, "hold"_a = usual.hold,
          "Rests at `start` until the first sample.")
      .def(
          "put",
          [](RotationStream& self, double time, const nb::object& rotation,
             const nb::object& angular_velocity) {
            return self.put({.time = time,
                             .rotation = rotation_from(rotation, "target"),
                             .angular_velocity = point_at(angular_velocity)});
          },
          "time"_a, "rotation"_a, "angular_velocity"_a = nb::make_tuple(0.0, 0.0, 0.0),
          "A sample of that time [s, on the clock of Controller.update], rotation and angular velocity along "
          "the world's "
          "axes [rad/s]. False, and nothing changes, for what is not finite, no rotation, or no later than "
          "the one before.");
}

}  // namespace

Target<PointTarget> point_from(const nb::object& target) {
  if (Target<PointTarget> path{PointTarget{}}; nb::try_cast(target, path)) {
    return path;
  }
  if (nb::isinstance<PointStream>(target)) {
    return nb::cast<const PointStream&>(target).target();
  }
  if (PyCallable_Check(target.ptr()) == 0) {
    return PointTarget{.position = point_at(target)};
  }
  return moving_target<PointTarget>([target](double t) {
    const nb::tuple sample = nb::cast<nb::tuple>(target(t));
    return PointTarget{.position = point_at(sample[0]), .velocity = point_at(sample[1])};
  });
}

Target<RotationTarget> rotating_from(const nb::object& target) {
  if (Target<RotationTarget> path{RotationTarget{}}; nb::try_cast(target, path)) {
    return path;
  }
  if (nb::isinstance<RotationStream>(target)) {
    return nb::cast<const RotationStream&>(target).target();
  }
  if (PyCallable_Check(target.ptr()) == 0) {
    return RotationTarget{.rotation = rotation_from(target, "target")};
  }
  return moving_target<RotationTarget>([target](double t) {
    const nb::tuple sample = nb::cast<nb::tuple>(target(t));
    return RotationTarget{.rotation = rotation_from(sample[0], "target"),
                          .angular_velocity = point_at(sample[1])};
  });
}

void bind_targets(nb::module_& module) {
  using Points = Target<PointTarget>;
  using Rotations = Target<RotationTarget>;
  nb::class_<Points>(module, "PointPath",
                     "A target that passes points at given times, smoothly in velocity and acceleration.")
      .def(
          "__init__",
          [](Points* self, const std::vector<double>& times, const nb::sequence& points) {
            new (self) Points(through(waypoints_from<PointWaypoint>(times, points, point_at)));
          },
          "times"_a, "points"_a, "Times [s] that rise, and a point [m] for each; at rest before and after.")
      .def(
          "at",
          [](const Points& self, double t) {
            const PointTarget now = self.at(t);
            return nb::make_tuple(now.position, now.velocity, now.acceleration);
          },
          "t"_a, "Position [m], velocity [m/s] and acceleration [m/s2] at a time [s].");
  nb::class_<Rotations>(
      module, "RotationPath",
      "A target that passes rotations at given times, smoothly in velocity and acceleration.")
      .def(
          "__init__",
          [](Rotations* self, const std::vector<double>& times, const nb::sequence& rotations) {
            new (self) Rotations(
                through(waypoints_from<RotationWaypoint>(times, rotations, [](const nb::handle& rotation) {
                  return rotation_from(rotation, "target");
                })));
          },
          "times"_a, "rotations"_a,
          "Times [s] that rise, and a rotation for each, a matrix or a quaternion (w, x, y, z); at rest "
          "before and "
          "after.")
      .def(
          "at",
          [](const Rotations& self, double t) {
            const RotationTarget now = self.at(t);
            return nb::make_tuple(now.rotation, now.angular_velocity, now.angular_acceleration);
          },
          "t"_a,
          "Rotation, angular velocity [rad/s] and acceleration [rad/s2] at a time [s], along fixed axes.");
  bind_streams(module);
}

}  // namespace tope::python
