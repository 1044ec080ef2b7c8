#include "bindings.hpp"
#include "numbers.hpp"
#include "task_spec.hpp"

#include <tope/common/error.hpp>
#include <tope/common/names.hpp>
#include <tope/controller/controller.hpp>
#include <tope/limit/servo_gains.hpp>

#include <algorithm>

namespace nb = nanobind;
using namespace nb::literals;

namespace tope::python {
namespace {

std::size_t choice(const std::string& what, const std::string& value, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), value);
  if (found == names.end()) {
    throw ConfigError("unknown " + what + " '" + value + "'" + name_hint(value, names));
  }
  return static_cast<std::size_t>(found - names.begin());
}

using OptionalNumber = std::optional<double>;

/// The poles that both pairs of arguments stand for; `lambda_p` and `lambda_v` are the paper's.
void set_servo(JointLimitOptions& rows, OptionalNumber gain, OptionalNumber servo_gain,
               OptionalNumber lambda_p, OptionalNumber lambda_v) {
  rows.gain = gain;
  rows.servo_gain = servo_gain.value_or(rows.servo_gain);
  if (!lambda_p && !lambda_v) {
    return;
  }
  if (gain || servo_gain || !lambda_p || !lambda_v) {
    throw ConfigError(
        "limits: give gain and servo_gain, or lambda_p and lambda_v, whose poles they are: one complete "
        "pair");
  }
  const ServoGains gains = ServoGains::from_paper(*lambda_p, *lambda_v);
  rows.gain = gains.gain;
  rows.servo_gain = gains.servo_gain;
}

void bind_options(nb::module_& module) {
  nb::class_<Smoothing>(
      module, "Smoothing",
      "The mean of `solutions` commands whose headrooms are between the first and `1 + spread` times "
      "that: weaker kinks where bounds become active, at so many times the cost.")
      .def(
          "__init__",
          [](Smoothing* self, int solutions, double spread) {
            const Smoothing smoothing{.solutions = solutions, .spread = spread};
            smoothing.check();
            new (self) Smoothing(smoothing);
          },
          nb::kw_only(), "solutions"_a = Smoothing{}.solutions, "spread"_a = Smoothing{}.spread);
  nb::class_<UnilateralOptions>(module, "UnilateralOptions", "Parameters of the method `unilateral`.")
      .def(
          "__init__",
          [](UnilateralOptions* self, OptionalNumber damping, OptionalNumber fine_damping,
             OptionalNumber fine_below, OptionalNumber lock, OptionalNumber headroom,
             OptionalNumber free_headroom, OptionalNumber inequality_headroom, OptionalNumber softness,
             const std::optional<Smoothing>& smoothing) {
            new (self) UnilateralOptions{.damping = damping,
                                         .fine_damping = fine_damping,
                                         .fine_below = fine_below,
                                         .lock = lock,
                                         .headroom = headroom,
                                         .free_headroom = free_headroom,
                                         .inequality_headroom = inequality_headroom,
                                         .softness = softness,
                                         .smoothing = smoothing};
          },
          nb::kw_only(), "damping"_a = nb::none(), "fine_damping"_a = nb::none(), "fine_below"_a = nb::none(),
          "lock"_a = nb::none(), "headroom"_a = nb::none(), "free_headroom"_a = nb::none(),
          "inequality_headroom"_a = nb::none(), "softness"_a = nb::none(), "smoothing"_a = nb::none(),
          "What is None is chosen for the mode and the robot; no smoothing.");
  nb::class_<PotentialFieldOptions>(module, "PotentialFieldOptions",
                                    "Parameters of the method `potential_field`.")
      .def(
          "__init__",
          [](PotentialFieldOptions* self, const std::vector<std::string>& joints, double influence,
             double strength) {
            new (self) PotentialFieldOptions{.joints = joints, .influence = influence, .strength = strength};
          },
          nb::kw_only(), "joints"_a = std::vector<std::string>{},
          "influence"_a = PotentialFieldOptions{}.influence, "strength"_a = PotentialFieldOptions{}.strength);
  nb::class_<LimitOptions>(module, "LimitOptions", "How joint limits are met.")
      .def(
          "__init__",
          [](LimitOptions* self, const std::string& method, double buffer, OptionalNumber gain, double margin,
             const std::string& ramp, const std::map<std::string, double>& buffers,
             const std::map<std::string, double>& gains, OptionalNumber servo_gain, OptionalNumber lambda_p,
             OptionalNumber lambda_v, const std::string& measure, const UnilateralOptions& unilateral,
             const PotentialFieldOptions& potential_field, const std::optional<CollisionOptions>& collisions,
             bool enforce_conditions) {
            new (self) LimitOptions{
                .method = limit_method_from(method),
                .rows = {.buffer = buffer,
                         .buffers = buffers,
                         .gains = gains,
                         .ramp = static_cast<Ramp>(choice("ramp", ramp, {"raised_cosine", "quintic"})),
                         .measure =
                             static_cast<Measure>(choice("measure", measure, {"predicted", "position"})),
                         .margin = margin},
                .unilateral = unilateral,
                .potential_field = potential_field,
                .collisions = collisions,
                .enforce_conditions = enforce_conditions};
            set_servo(self->rows, gain, servo_gain, lambda_p, lambda_v);
          },
          nb::kw_only(), "method"_a = to_string(LimitOptions{}.method),
          "buffer"_a = JointLimitOptions{}.buffer, "gain"_a = nb::none(),
          "margin"_a = JointLimitOptions{}.margin, "ramp"_a = "raised_cosine",
          "buffers"_a = std::map<std::string, double>{}, "gains"_a = std::map<std::string, double>{},
          "servo_gain"_a = nb::none(), "lambda_p"_a = nb::none(), "lambda_v"_a = nb::none(),
          "measure"_a = "predicted", "unilateral"_a = UnilateralOptions{},
          "potential_field"_a = PotentialFieldOptions{}, "collisions"_a = nb::none(),
          "enforce_conditions"_a = true);
}

void bind_status(nb::module_& module) {
  nb::class_<Status>(module, "Status", "What acted in one cycle.")
      .def_prop_ro("ok", &Status::ok)
      .def_prop_ro("events",
                   [](const Status& status) {
                     std::vector<std::string> names;
                     for (const Event event : all_events) {
                       if (status.has(event)) {
                         names.emplace_back(to_string(event));
                       }
                     }
                     return names;
                   })
      .def_ro("scale", &Status::scale)
      .def_ro("laws", &Status::laws)
      .def("__str__", &event_names);
  nb::class_<TaskHandle>(module, "TaskHandle", "Names a task inside the controller that returned it.");
}

std::map<std::string, double> named_activations(const Controller& controller) {
  std::map<std::string, double> named;
  for (int j = 0; j < controller.robot().nv(); ++j) {
    if (!controller.limits().limited(j)) {
      continue;
    }
    const std::string& joint = controller.robot().joint_names()[static_cast<std::size_t>(j)];
    named[joint + ".upper"] = controller.upper_activation()[j];
    named[joint + ".lower"] = controller.lower_activation()[j];
  }
  return named;
}

std::map<std::string, double> named_distances(const Controller& controller) {
  std::map<std::string, double> named;
  if (const CollisionLimits* collisions = controller.collisions()) {
    for (int i = 0; i < collisions->size(); ++i) {
      named[collisions->names()[static_cast<std::size_t>(i)]] = collisions->distance()[i];
    }
  }
  return named;
}

}  // namespace

void bind_controller(nb::module_& module) {
  bind_options(module);
  bind_status(module);
  nb::class_<Controller>(module, "Controller",
                         "Serves tasks in strict order of priority and keeps joint limits.")
      .def(
          "__init__",
          [](Controller* self, const Robot& robot, const std::string& mode, double dt,
             const LimitOptions& limits, const std::vector<double>& joint_weights,
             const std::string& null_space, bool midpoint, const std::string& wheel_distribution) {
            robot.check_bounds();
            new (self) Controller(
                robot, {.mode = static_cast<Mode>(choice("mode", mode, {"velocity", "torque"})),
                        .dt = dt,
                        .limits = limits,
                        .singularities = {},
                        .null_space = static_cast<NullSpace>(
                            choice("null_space", null_space, {"compensated", "zero_torque"})),
                        .midpoint = midpoint,
                        .wheel_distribution = static_cast<WheelDistribution>(choice(
                            "wheel_distribution", wheel_distribution, {"minimum_norm", "minimum_peak"})),
                        .joint_weights = joint_weights});
          },
          "robot"_a, nb::kw_only(), "mode"_a, "dt"_a, "limits"_a = LimitOptions{},
          "joint_weights"_a = std::vector<double>{}, "null_space"_a = "compensated", "midpoint"_a = true,
          "wheel_distribution"_a = "minimum_norm", "Takes a copy of the robot with its bounds as they are.")
      .def(
          "add",
          [](Controller& controller, const TaskSpec& spec, int level, double over) {
            return controller.add(level, *spec.make(controller.robot()), {.over = over});
          },
          "task"_a, nb::kw_only(), "level"_a, "over"_a = 0.0, "Adds a task; `over` seconds let it fade in.")
      .def(
          "remove",
          [](Controller& controller, TaskHandle handle, double over) {
            controller.remove(handle, {.over = over});
          },
          "handle"_a, nb::kw_only(), "over"_a = 0.0, "Removes a task; `over` seconds let it fade out.")
      .def(
          "move",
          [](Controller& controller, TaskHandle handle, int level, double over) {
            controller.move(handle, level, {.over = over});
          },
          "handle"_a, nb::kw_only(), "level"_a, "over"_a = 0.0,
          "Moves a task to another level, in `over` seconds; it is complete all the while.")
      .def(
          "replace",
          [](Controller& controller, TaskHandle handle, const TaskSpec& spec, double over) {
            controller.replace(handle, *spec.make(controller.robot()), {.over = over});
          },
          "handle"_a, "task"_a, nb::kw_only(), "over"_a = 0.0,
          "Puts another task in the place of one, in `over` seconds: with another target for example.")
      .def(
          "move_limits",
          [](Controller& controller, const std::string& joint, double lower, double upper, double lower_rate,
             double upper_rate) {
            const LimitMotion motion{
                .lower = lower, .upper = upper, .lower_rate = lower_rate, .upper_rate = upper_rate};
            if (!controller.move_limits(controller.robot().joint_index(joint), motion)) {
              throw ConfigError(
                  "move_limits: " + joint +
                  ": the limits must be further apart than their buffers, and the rates finite");
            }
          },
          "joint"_a, nb::kw_only(), "lower"_a, "upper"_a, "lower_rate"_a = 0.0, "upper_rate"_a = 0.0,
          "Moves a joint's limits [rad or m] from the next update on; the rates [rad/s or m/s] say how they "
          "go on.")
      .def(
          "move_obstacle",
          [](Controller& controller, const std::string& body, const nb::object& position,
             const nb::object& rotation, const nb::object& velocity, const nb::object& angular_velocity) {
            const CollisionLimits* collisions = controller.collisions();
            if (collisions == nullptr) {
              throw ConfigError("move_obstacle: the controller keeps no distances");
            }
            const BodyMotion motion{.position = three_numbers(position, "position"),
                                    .rotation = rotation_from(rotation, "rotation"),
                                    .velocity = three_numbers(velocity, "velocity"),
                                    .angular_velocity = three_numbers(angular_velocity, "angular_velocity")};
            if (!controller.move_obstacle(collisions->body_index(body), motion)) {
              throw ConfigError("move_obstacle: " + body +
                                ": only a body that the world carries can be moved, by finite numbers and a "
                                "rotation");
            }
          },
          "body"_a, nb::kw_only(), "position"_a, "rotation"_a = unit_quaternion(),
          "velocity"_a = nb::make_tuple(0.0, 0.0, 0.0), "angular_velocity"_a = nb::make_tuple(0.0, 0.0, 0.0),
          "Moves an obstacle [m] from the next update on; its velocities [m/s, rad/s] say how it goes on.")
      .def(
          "update",
          [](Controller& controller, const Vector& q, const Vector& v, double t) {
            Vector u = Vector::Zero(controller.robot().nv());
            controller.update(q, v, t, u);
            if (PyErr_Occurred() != nullptr) {  // a moving target raised
              throw nb::python_error();
            }
            return u;
          },
          "q"_a, "v"_a, "t"_a, "One cycle: the command (nv) at state q (nq), v (nv) and time t [s].")
      .def(
          "error",
          [](const Controller& controller, TaskHandle handle) -> Vector {
            return controller.task(handle).error();
          },
          "handle"_a, "Error of a task as of the last update.")
      .def_prop_ro("status", &Controller::status)
      .def_prop_ro(
          "limit_gains", [](const Controller& controller) { return controller.limits().gains(); },
          "Gain of each joint's limits (nv) [1/s]: as given, or as chosen for the mode and its drive.")
      .def_prop_ro("status_text", &Controller::status_text)
      .def_prop_ro("activations", &named_activations, "How active each limit is, 0 to 1, by 'joint.side'.")
      .def_prop_ro("distances", &named_distances,
                   "Distance [m] of each pair that is kept apart, by 'sphere.body', as of the last update.");
}

}  // namespace tope::python
