#include "../common/yaml_reader.hpp"
#include "../robot/collision_reader.hpp"
#include "change_reader.hpp"
#include "mujoco_reader.hpp"
#include "task_reader.hpp"

#include <tope/limit/servo_gains.hpp>
#include <tope/robot/package_path.hpp>
#include <tope/scenario/scenario.hpp>
#include <tope/task/damping.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tope {
namespace {

Robot read_robot(const YamlReader& yaml, Scenario& scenario) {
  const std::filesystem::path given = yaml.path("urdf");
  const std::filesystem::path urdf = located(yaml, "urdf", [&] { return package_path(given); });
  scenario.urdf = std::filesystem::absolute(urdf).lexically_normal();
  const bool has_config = yaml.has("config");
  const std::filesystem::path config = has_config ? yaml.path("config") : "";
  yaml.finish();
  return has_config ? Robot::from_urdf(urdf, config) : Robot::from_urdf(urdf);
}

/// `speed_bound` is the joint's: beyond its limit it is led back at no more than half of that.
MovingLimit read_moving_limit(const YamlReader& yaml, int joint, double speed_bound) {
  MovingLimit moving;
  moving.joint = joint;
  moving.velocity = yaml.number("velocity");
  if (std::abs(moving.velocity) >= 0.5 * speed_bound) {
    yaml.fail("velocity", "must be below half of the speed bound, " + std::to_string(0.5 * speed_bound) +
                              ", got " + std::to_string(moving.velocity));
  }
  moving.start = yaml.number("at");
  moving.duration = yaml.positive("for");
  yaml.finish();
  return moving;
}

/// `limits.joints`: limits, buffers and gains that this scenario sets, an obstacle for example.
void read_joint_limits(const YamlReader& joints, Robot& robot, JointLimitOptions& options,
                       std::vector<MovingLimit>& moving) {
  Vector lower = robot.position_lower();
  Vector upper = robot.position_upper();
  Vector velocity = robot.velocity_limit();
  for (const std::string& name : joints.keys()) {
    const int joint = located(joints, name, [&] { return robot.joint_index(name); });
    const YamlReader yaml = joints.map(name);
    lower[joint] = yaml.number("lower", lower[joint]);
    upper[joint] = yaml.number("upper", upper[joint]);
    velocity[joint] = yaml.positive("velocity", velocity[joint]);
    if (yaml.has("buffer")) {
      options.buffers[name] = yaml.positive("buffer");
    }
    if (yaml.has("gain")) {
      options.gains[name] = yaml.positive("gain");
    }
    if (const auto motion = yaml.optional_map("upper_motion")) {
      moving.push_back(read_moving_limit(*motion, joint, velocity[joint]));
    }
    yaml.finish();
    located(joints, name, [&] { robot.set_position_limits(lower, upper); });
  }
  robot.set_velocity_limit(velocity);
}

/// Either the library's `gain` and `servo_gain`, or the paper's `lambda_p` and `lambda_v`.
void read_servo(const YamlReader& yaml, JointLimitOptions& options) {
  if (!yaml.has("lambda_p") && !yaml.has("lambda_v")) {
    options.gain = yaml.optional_positive("gain");
    options.servo_gain = yaml.positive("servo_gain", options.servo_gain);
    return;
  }
  for (const char* key : {"gain", "servo_gain"}) {
    if (yaml.has(key)) {
      yaml.fail(key,
                "gain and servo_gain are the poles of lambda_p and lambda_v: give one pair or the other");
    }
  }
  const double lambda_p = yaml.positive("lambda_p");
  const double lambda_v = yaml.positive("lambda_v");
  const ServoGains gains =
      located(yaml, "lambda_v", [&] { return ServoGains::from_paper(lambda_p, lambda_v); });
  options.gain = gains.gain;
  options.servo_gain = gains.servo_gain;
}

Smoothing read_smoothing(const YamlReader& yaml) {
  Smoothing smoothing;
  smoothing.spread = yaml.positive("spread", smoothing.spread);
  smoothing.solutions = yaml.integer("solutions", smoothing.solutions);
  located(yaml, "solutions", [&] { smoothing.check(); });
  yaml.finish();
  return smoothing;
}

LimitOptions read_limits(const YamlReader& yaml, Robot& robot, std::vector<MovingLimit>& moving) {
  LimitOptions limits;
  const std::string method = yaml.text("method", to_string(limits.method));
  limits.method = located(yaml, "method", [&] { return limit_method_from(method); });
  limits.rows.buffer = yaml.positive("buffer", limits.rows.buffer);
  read_servo(yaml, limits.rows);
  limits.rows.margin = yaml.positive("margin", limits.rows.margin);
  static const std::vector<std::string> measures{"predicted", "position"};
  limits.rows.measure =
      static_cast<Measure>(choice(yaml, "measure", yaml.text("measure", measures[0]), measures));
  static const std::vector<std::string> ramps{"raised_cosine", "quintic"};
  limits.rows.ramp = static_cast<Ramp>(choice(yaml, "ramp", yaml.text("ramp", ramps[0]), ramps));
  static const std::vector<std::string> handling{"enforce", "report"};
  limits.enforce_conditions = choice(yaml, "conditions", yaml.text("conditions", handling[0]), handling) == 0;
  if (const auto joints = yaml.optional_map("joints")) {
    read_joint_limits(*joints, robot, limits.rows, moving);
  }
  if (const auto law = yaml.optional_map("unilateral")) {
    limits.unilateral.damping = law->optional_positive("damping");
    limits.unilateral.fine_damping = law->optional_positive("fine_damping");
    limits.unilateral.fine_below = law->optional_positive("fine_below");
    limits.unilateral.lock = law->optional_positive("lock");
    limits.unilateral.headroom = law->optional_positive("headroom");
    limits.unilateral.free_headroom = law->optional_positive("free_headroom");
    limits.unilateral.inequality_headroom = law->optional_positive("inequality_headroom");
    limits.unilateral.softness = law->optional_positive("softness");
    if (const auto smoothing = law->optional_map("smoothing")) {
      limits.unilateral.smoothing = read_smoothing(*smoothing);
    }
    law->finish();
  }
  if (const auto field = yaml.optional_map("potential_field")) {
    if (field->has("joints")) {
      limits.potential_field.joints = field->texts("joints");
    }
    limits.potential_field.influence = field->positive("influence", limits.potential_field.influence);
    limits.potential_field.strength = field->positive("strength", limits.potential_field.strength);
    field->finish();
  }
  yaml.finish();
  return limits;
}

/// `collisions`: distances to keep between the robot's spheres and obstacles, beside those of the robot's own file.
CollisionOptions read_collisions(const YamlReader& yaml) {
  CollisionOptions options;
  options.geometry = read_collision_geometry(yaml, "obstacles");
  options.margin = yaml.positive("margin", options.margin);
  options.gain = yaml.optional_positive("gain");
  options.servo_gain = yaml.optional_positive("servo_gain");
  yaml.finish();
  return options;
}

Hierarchy::Options read_singularities(const YamlReader& yaml) {
  Hierarchy::Options options;
  options.damped_below = yaml.positive("damped_below", options.damped_below);
  options.locked_above = yaml.positive("locked_above", options.locked_above);
  options.epsilon = yaml.positive("epsilon", options.epsilon);
  yaml.finish();
  return options;
}

Vector read_initial(const YamlReader& yaml, const Robot& robot) {
  const YamlReader joints = yaml.map("initial");
  Vector q(robot.nq());
  for (const std::string& name : robot.joint_names()) {
    q[robot.joint_index(name)] = joints.number(name, 0.0);
  }
  joints.finish();
  return q;
}

std::vector<ScenarioTask> read_tasks(const YamlReader& yaml, const Robot& robot) {
  std::vector<ScenarioTask> tasks;
  for (const YamlReader& item : yaml.list_of_maps("tasks")) {
    tasks.push_back(read_task(item, robot));
    const auto same_name = [&](const ScenarioTask& task) { return task.name == tasks.back().name; };
    if (std::count_if(tasks.begin(), tasks.end(), same_name) > 1) {
      item.fail("name", "a second task is named '" + tasks.back().name + "'");
    }
  }
  if (tasks.empty()) {
    yaml.fail("tasks", "names no task");
  }
  return tasks;
}

RigidBodyOptions read_rigid_body(const YamlReader& yaml) {
  RigidBodyOptions options;
  static const std::vector<std::string> integrators{"semi_implicit", "rk4"};
  options.integrator = static_cast<RigidBodyOptions::Integrator>(
      choice(yaml, "integrator", yaml.text("integrator", "rk4"), integrators));
  options.substeps = yaml.integer("substeps", options.substeps);
  options.friction = yaml.flag("friction", false);
  options.inertia_scale = yaml.positive("inertia_scale", options.inertia_scale);
  options.payload = yaml.number("payload", options.payload);
  options.payload_frame = yaml.text("payload_frame", options.payload_frame);
  options.torque_noise = yaml.number("torque_noise", options.torque_noise);
  options.seed = static_cast<std::uint64_t>(yaml.integer("seed", static_cast<int>(options.seed)));
  options.delay = yaml.number("delay", options.delay);
  yaml.finish();
  return options;
}

/// `plant: {type: ..., options}`; each mode has its own.
void read_plant(const YamlReader& yaml, Scenario& scenario) {
  const bool torque = scenario.controller.mode == Mode::torque;
  scenario.plant = torque ? "rigid_body" : "kinematic";
  const auto plant = yaml.optional_map("plant");
  if (!plant) {
    return;
  }
  const std::string type = plant->text("type", scenario.plant);
  choice(*plant, "type", type, {"kinematic", "rigid_body", "mujoco"});
  if (type != scenario.plant && type != "mujoco") {
    plant->fail("type", "'" + type + "' does not follow commands of this mode; expected '" + scenario.plant +
                            "' or 'mujoco'");
  }
  scenario.plant = type;
  if (type == "mujoco") {
    scenario.mujoco = read_mujoco(*plant);
  } else if (torque) {
    scenario.rigid_body = read_rigid_body(*plant);
  }
  plant->finish();
}

void read_torque_options(const YamlReader& yaml, ControllerOptions& options) {
  static const std::vector<std::string> null_spaces{"compensated", "zero_torque"};
  options.null_space = static_cast<NullSpace>(
      choice(yaml, "null_space", yaml.text("null_space", null_spaces[0]), null_spaces));
  options.midpoint = yaml.flag("midpoint", options.midpoint);
  static const std::vector<std::string> distributions{"minimum_norm", "minimum_peak"};
  options.wheel_distribution = static_cast<WheelDistribution>(
      choice(yaml, "wheel_distribution", yaml.text("wheel_distribution", distributions[0]), distributions));
}

/// In torque mode some task must take the freedom that is left, or it drifts.
void add_lowest_level(const Robot& robot, Scenario& scenario) {
  int lowest = 0;
  for (std::size_t i = 0; i < scenario.tasks.size(); ++i) {
    const TaskCourse course = scenario.course(i);
    lowest = std::max(lowest, course.lowest_level);
    if (scenario.tasks[i].task->size() >= robot.nv() && course.always) {
      return;
    }
  }
  scenario.tasks.push_back(
      {.name = "damping", .level = lowest + 1, .task = std::make_shared<Damping>(robot)});
  scenario.notices.push_back(
      "No task takes all the freedom that is left: a damping task was added at level " +
      std::to_string(lowest + 1) + ".");
}

/// How the simulated robot differs from the one that the controller believes in; empty when it does not.
std::string model_errors(const RigidBodyOptions& plant) {
  std::ostringstream text;
  const auto separate = [&] { text << (text.tellp() > 0 ? ", " : ""); };
  if (plant.inertia_scale != 1.0) {
    text << "links " << plant.inertia_scale << " times as heavy";
  }
  if (plant.payload > 0.0) {
    separate();
    text << plant.payload << " kg at " << plant.payload_frame;
  }
  if (plant.delay > 0.0) {
    separate();
    text << "commands " << 1e3 * plant.delay << " ms late";
  }
  if (plant.friction) {
    separate();
    text << "friction in the joints";
  }
  if (plant.torque_noise > 0.0) {
    separate();
    text << "torque noise of " << 100.0 * plant.torque_noise << " % of the effort";
  }
  return text.str();
}

void add_notices(const Robot& robot, Scenario& scenario) {
  const ControllerOptions& options = scenario.controller;
  if (options.limits.method == LimitMethod::none) {
    scenario.notices.emplace_back("Joint limits are not kept: limits.method is none.");
  }
  if (options.limits.method == LimitMethod::potential_field) {
    scenario.notices.emplace_back(
        "A potential field acts in the null space of the tasks and keeps no limit by itself.");
  }
  if (options.mode == Mode::torque && options.limits.rows.measure == Measure::position) {
    scenario.notices.emplace_back(
        "Activations are measured on the position, as in the paper: fast joints overshoot their limits.");
  }
  if (!options.limits.enforce_conditions) {
    scenario.notices.emplace_back(
        "Safety inequalities are reported, not enforced: limits.conditions is report.");
  }
  if (const std::string errors = model_errors(scenario.rigid_body); !errors.empty()) {
    scenario.notices.push_back("The robot is not the one that the controller believes in: " + errors + ".");
  }
  if (options.mode == Mode::torque && options.null_space == NullSpace::compensated) {
    add_lowest_level(robot, scenario);
  }
}

}  // namespace

double MovingLimit::moved(double t) const { return velocity * std::clamp(t - start, 0.0, duration); }

double MovingLimit::rate(double t) const { return t >= start && t < start + duration ? velocity : 0.0; }

const Vector& Scenario::command_bound() const {
  return controller.mode == Mode::torque ? robot->effort_limit() : robot->velocity_limit();
}

TaskCourse Scenario::course(std::size_t task) const {
  const Task* now = tasks[task].task.get();
  double begun = 0.0;
  TaskCourse course;
  course.lowest_level = tasks[task].level;
  bool first = true;
  for (const TaskChange& change : changes) {
    if (change.task != task) {
      continue;
    }
    switch (change.kind) {
      case TaskChange::Kind::add:
        course.at_start = course.at_start && !first;
        course.at_end = true;
        begun = change.at;
        break;
      case TaskChange::Kind::remove:
        course.at_end = false;
        course.always = false;
        break;
      case TaskChange::Kind::move:
        course.lowest_level = std::max(course.lowest_level, change.level);
        break;
      case TaskChange::Kind::replace:
        now = change.with.get();
        begun = change.at;
        break;
    }
    first = false;
  }
  course.always = course.always && course.at_start;
  if (const auto promised = now->duration(); promised && course.at_end) {
    course.goal_time = begun + *promised;
  }
  return course;
}

Controller Scenario::build_controller() const {
  Controller built(*robot, controller);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (course(i).at_start) {
      built.add(tasks[i].level, *tasks[i].task);
    }
  }
  return built;
}

Scenario Scenario::load(const std::filesystem::path& file,
                        const std::map<std::string, std::string>& overrides) {
  const YamlReader yaml = YamlReader::load(file, overrides);
  Scenario scenario;
  scenario.file = file;
  scenario.name = yaml.text("name", file.stem().string());
  scenario.description = yaml.text("description", "");
  scenario.controller.mode =
      static_cast<Mode>(choice(yaml, "mode", yaml.text("mode"), {"velocity", "torque"}));
  scenario.controller.dt = yaml.positive("dt");
  scenario.duration = yaml.positive("duration");
  if (scenario.duration < scenario.controller.dt) {
    yaml.fail("duration", "must be at least dt");
  }
  Robot robot = read_robot(yaml.map("robot"), scenario);
  if (const auto limits = yaml.optional_map("limits")) {
    scenario.controller.limits = read_limits(*limits, robot, scenario.moving_limits);
  }
  if (const auto collisions = yaml.optional_map("collisions")) {
    const CollisionOptions options = read_collisions(*collisions);
    located(yaml, "collisions", [&] {
      CollisionLimits(robot, options, JointLimits::default_gain, JointLimitOptions{}.servo_gain);
    });
    scenario.controller.limits.collisions = options;
  }
  if (const auto singularities = yaml.optional_map("singularities")) {
    scenario.controller.singularities = read_singularities(*singularities);
  }
  if (yaml.has("joint_weights")) {
    const Vector weights = yaml.vector("joint_weights", robot.nv());
    scenario.controller.joint_weights.assign(weights.begin(), weights.end());
  }
  read_plant(yaml, scenario);
  if (scenario.controller.mode == Mode::torque) {
    read_torque_options(yaml, scenario.controller);
  }
  if (const auto log = yaml.optional_map("log")) {
    scenario.log_every = log->integer("every", 1);
    if (scenario.log_every < 1) {
      log->fail("every", "must be at least 1 cycle");
    }
    log->finish();
  }
  scenario.initial = read_initial(yaml, robot);
  scenario.tasks = read_tasks(yaml, robot);
  scenario.changes = read_changes(yaml, robot, scenario.tasks);
  yaml.finish();
  add_notices(robot, scenario);
  scenario.robot = std::make_shared<const Robot>(std::move(robot));
  return scenario;
}

}  // namespace tope
