#include "bindings.hpp"

#include <tope/scenario/live_simulation.hpp>

#include <Eigen/Geometry>

#include <array>
#include <utility>

namespace nb = nanobind;
using namespace nb::literals;

namespace tope::python {
namespace {

using Quaternion = std::array<double, 4>;  // w, x, y, z

Quaternion wxyz(const Matrix3& rotation) {
  const Eigen::Quaterniond q(rotation);
  return {q.w(), q.x(), q.y(), q.z()};
}

std::map<std::string, std::pair<Vector3, Quaternion>> goals(const LiveSimulation& live) {
  std::map<std::string, std::pair<Vector3, Quaternion>> placements;
  for (const auto& [frame, goal] : live.goals()) {
    placements[frame] = {goal->put_position(), wxyz(goal->put_rotation())};
  }
  return placements;
}

void put_goal(LiveSimulation& live, const std::string& frame, const Vector3& position, const Quaternion& q) {
  live.put_goal(frame, position, Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix());
}

/// Norm of each task's error; None for a task that is not present.
nb::dict errors(const LiveSimulation& live) {
  const ClosedLoop& loop = live.loop();
  nb::dict norms;
  for (std::size_t i = 0; i < loop.scenario().tasks.size(); ++i) {
    const Task* task = loop.task(i);
    norms[loop.scenario().tasks[i].name.c_str()] =
        task != nullptr ? nb::cast(task->error().norm()) : nb::none();
  }
  return norms;
}

}  // namespace

void bind_live(nb::module_& module) {
  nb::class_<LiveSimulation>(
      module, "LiveSimulation",
      "A scenario that never ends and that can be changed while it runs. For one thread.")
      .def(nb::init<const Scenario&>(), "scenario"_a)
      .def("advance", &LiveSimulation::advance, "seconds"_a, nb::call_guard<nb::gil_scoped_release>(),
           "Runs the cycles that fit into so many seconds and what an earlier call left over.")
      .def("put_goal", &put_goal, "frame"_a, "position"_a, "wxyz"_a,
           "Puts the goal of a frame to a position [m] and a unit quaternion.")
      .def("adopt", &LiveSimulation::adopt, "scenario"_a,
           "Goes on under another reading of the same scenario file; ConfigError leaves all as it was.")
      .def("insert", &LiveSimulation::insert, "task"_a, nb::kw_only(), "over"_a,
           "Adds a task that was removed, over so many seconds.")
      .def("remove", &LiveSimulation::remove, "task"_a, nb::kw_only(), "over"_a,
           "Removes a task, over so many seconds.")
      .def_prop_ro("time", [](const LiveSimulation& live) { return live.loop().time(); })
      .def_prop_ro("position", [](const LiveSimulation& live) -> Vector { return live.loop().position(); })
      .def_prop_ro("velocity", [](const LiveSimulation& live) -> Vector { return live.loop().velocity(); })
      .def_prop_ro("command", [](const LiveSimulation& live) -> Vector { return live.loop().command(); })
      .def_prop_ro(
          "upper_activation",
          [](const LiveSimulation& live) -> Vector { return live.loop().controller().upper_activation(); })
      .def_prop_ro(
          "lower_activation",
          [](const LiveSimulation& live) -> Vector { return live.loop().controller().lower_activation(); })
      .def_prop_ro("status",
                   [](const LiveSimulation& live) { return event_names(live.loop().controller().status()); })
      .def_prop_ro("status_text",
                   [](const LiveSimulation& live) { return live.loop().controller().status_text(); })
      .def_prop_ro(
          "limit_gain",
          [](const LiveSimulation& live) { return live.loop().controller().limits().least_gain(); },
          "The least gain of the joints' limits [1/s], chosen by the controller if the scenario does not "
          "say.")
      .def_prop_ro("errors", &errors,
                   "Norm of each task's error [m or rad]; None for a task that is not present.")
      .def_prop_ro("goals", &goals, "Position [m] and quaternion (w, x, y, z) of the goal of each frame.");
}

}  // namespace tope::python
