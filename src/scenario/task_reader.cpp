#include "task_reader.hpp"

#include <tope/common/names.hpp>
#include <tope/reference/waypoints.hpp>
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

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <utility>

namespace tope {
namespace {

Reference read_reference(const YamlReader& task) {
  const auto yaml = task.optional_map("reference");
  if (!yaml) {
    return Exponential{};
  }
  static const std::vector<std::string> types{"exponential", "predefined_time"};
  const std::string type = yaml->text("type");
  Reference reference;
  if (type == types[0]) {
    reference = Exponential{{.gain = yaml->positive("gain")}};
  } else if (type == types[1]) {
    reference =
        PredefinedTime{{.duration = yaml->positive("duration"),
                        .gain = yaml->positive("gain"),
                        .replan_over = yaml->has("replan_over") ? yaml->positive("replan_over") : 0.0}};
  } else {
    yaml->fail("type", "unknown reference '" + type + "'" + name_hint(type, types));
  }
  yaml->finish();
  return reference;
}

Target<PointTarget> read_point(const YamlReader& yaml) {
  if (yaml.has("waypoints")) {
    std::vector<PointWaypoint> waypoints;
    for (const YamlReader& item : yaml.list_of_maps("waypoints")) {
      waypoints.push_back({item.number("at"), item.vector("position", 3)});
    }
    return located(yaml, "waypoints", [&] { return through(waypoints); });
  }
  const Vector3 position = yaml.vector("position", 3);
  if (yaml.has("velocity")) {
    return moving_along_line(position, yaml.vector("velocity", 3));
  }
  if (yaml.has("amplitude")) {
    return moving_along_sine(position, yaml.vector("amplitude", 3), yaml.positive("frequency"));
  }
  return PointTarget{.position = position};
}

/// Refuses what a target, or one of its waypoints, says beyond `parts`: "position", "quaternion" or both.
void finish_target(const YamlReader& target, const std::vector<std::string>& parts) {
  if (target.has("waypoints")) {
    for (const YamlReader& item : target.list_of_maps("waypoints")) {
      item.has("at");
      for (const std::string& part : parts) {
        item.has(part);
      }
      item.finish();
    }
  }
  target.finish();
}

/// The target of a task that is about a point alone.
Target<PointTarget> read_point_target(const YamlReader& yaml) {
  const YamlReader target = yaml.map("target");
  Target<PointTarget> point = read_point(target);
  finish_target(target, {"position"});
  return point;
}

Target<RotationTarget> read_rotation(const YamlReader& yaml) {
  if (yaml.has("waypoints")) {
    std::vector<RotationWaypoint> waypoints;
    for (const YamlReader& item : yaml.list_of_maps("waypoints")) {
      waypoints.push_back({item.number("at"), item.rotation("quaternion")});
    }
    return located(yaml, "waypoints", [&] { return through(waypoints); });
  }
  const Matrix3 rotation = yaml.rotation("quaternion");
  if (yaml.has("angular_velocity")) {
    return spinning(rotation, yaml.vector("angular_velocity", 3));
  }
  return RotationTarget{.rotation = rotation};
}

std::vector<int> read_row_numbers(const YamlReader& yaml) {
  const Vector numbers = yaml.vector("rows", -1);
  if ((numbers.array() != numbers.array().round()).any() || numbers.lpNorm<Eigen::Infinity>() > 1e6) {
    yaml.fail("rows", "expected whole numbers, counted from 0");
  }
  return {numbers.begin(), numbers.end()};
}

using TaskReader = std::function<std::shared_ptr<const Task>(const YamlReader&, const Robot&)>;

std::shared_ptr<const Task> read_position(const YamlReader& yaml, const Robot& robot) {
  return std::make_shared<FramePosition>(robot, yaml.text("frame"), read_point_target(yaml),
                                         read_reference(yaml));
}

std::shared_ptr<const Task> read_orientation(const YamlReader& yaml, const Robot& robot) {
  const YamlReader target = yaml.map("target");
  auto task = std::make_shared<FrameOrientation>(robot, yaml.text("frame"), read_rotation(target),
                                                 read_reference(yaml));
  finish_target(target, {"quaternion"});
  return task;
}

std::shared_ptr<const Task> read_pose(const YamlReader& yaml, const Robot& robot) {
  const YamlReader target = yaml.map("target");
  auto task = std::make_shared<FramePose>(robot, yaml.text("frame"), read_point(target),
                                          read_rotation(target), read_reference(yaml));
  finish_target(target, {"position", "quaternion"});
  return task;
}

/// True when a target, or the first of its waypoints, names the part.
bool names_part(const YamlReader& target, const std::string& part) {
  if (!target.has("waypoints")) {
    return target.has(part);
  }
  const std::vector<YamlReader> items = target.list_of_maps("waypoints");
  return !items.empty() && items.front().has(part);
}

std::shared_ptr<const Task> read_relative_pose(const YamlReader& yaml, const Robot& robot) {
  const YamlReader target = yaml.map("target");
  RelativeTarget relative;
  if (names_part(target, "position")) {
    relative.position = read_point(target);
  }
  if (names_part(target, "quaternion")) {
    relative.rotation = read_rotation(target);
  }
  auto task = std::make_shared<RelativePose>(robot, yaml.text("frame"), yaml.text("seen_from"), relative,
                                             read_reference(yaml));
  finish_target(target, {"position", "quaternion"});
  return task;
}

std::shared_ptr<const Task> read_pointing(const YamlReader& yaml, const Robot& robot) {
  return std::make_shared<Pointing>(robot, yaml.text("frame"), Vector3(yaml.vector("axis", 3)),
                                    read_point_target(yaml), read_reference(yaml));
}

std::shared_ptr<const Task> read_center_of_mass(const YamlReader& yaml, const Robot& robot) {
  return std::make_shared<CenterOfMass>(robot, read_point_target(yaml), read_reference(yaml));
}

std::shared_ptr<const Task> read_manipulability(const YamlReader& yaml, const Robot& robot) {
  ManipulabilityOptions options;
  if (const auto of = yaml.optional_map("of")) {
    if (of->has("rows")) {
      options.rows = read_row_numbers(*of);
    }
    if (of->has("joints")) {
      options.joints = of->texts("joints");
    }
    of->finish();
  }
  return std::make_shared<Manipulability>(robot, yaml.text("frame"), yaml.positive("target"), options,
                                          read_reference(yaml));
}

std::shared_ptr<const Task> read_posture(const YamlReader& yaml, const Robot& robot) {
  return std::make_shared<Posture>(robot, yaml.vector("target", robot.nq()), read_reference(yaml));
}

std::shared_ptr<const Task> read_joints(const YamlReader& yaml, const Robot& robot) {
  return std::make_shared<JointPosition>(robot, yaml.numbers("target"), read_reference(yaml));
}

std::shared_ptr<const Task> read_damping(const YamlReader& yaml, const Robot& robot) {
  return yaml.has("gain") ? std::make_shared<Damping>(robot, yaml.positive("gain"))
                          : std::make_shared<Damping>(robot);
}

/// Registration: a new task type is one line here.
const std::vector<std::pair<std::string, TaskReader>>& task_readers() {
  static const std::vector<std::pair<std::string, TaskReader>> readers{
      {"frame_position", read_position},
      {"frame_orientation", read_orientation},
      {"frame_pose", read_pose},
      {"posture", read_posture},
      {"joint_position", read_joints},
      {"damping", read_damping},
      {"pointing", read_pointing},
      {"center_of_mass", read_center_of_mass},
      {"relative_pose", read_relative_pose},
      {"manipulability", read_manipulability},
  };
  return readers;
}

std::shared_ptr<const Task> read_by_type(const YamlReader& yaml, const Robot& robot) {
  const std::string type = yaml.text("type");
  for (const auto& [name, reader] : task_readers()) {
    if (name == type) {
      return reader(yaml, robot);
    }
  }
  yaml.fail("type", "unknown task '" + type + "'" + name_hint(type, task_type_names()));
}

/// Of any task, `rows` keeps those alone.
std::shared_ptr<const Task> read_rows(const YamlReader& yaml, std::shared_ptr<const Task> task) {
  if (!yaml.has("rows")) {
    return task;
  }
  const std::vector<int> rows = read_row_numbers(yaml);
  return located(yaml, "rows", [&] { return std::make_shared<const SelectedRows>(*task, rows); });
}

/// Any task may be served by `joints` alone.
std::shared_ptr<const Task> read_group(const YamlReader& yaml, const Robot& robot,
                                       std::shared_ptr<const Task> task) {
  if (!yaml.has("joints")) {
    return task;
  }
  const std::vector<std::string> joints = yaml.texts("joints");
  return located(yaml, "joints", [&] { return std::make_shared<const JointGroup>(robot, *task, joints); });
}

/// The key that an error of a task's constructor is about, as far as its words tell.
std::string blamed_key(const YamlReader& yaml, const std::string& message) {
  if (message.starts_with("Pointing: axis")) {
    return "axis";
  }
  if (message.starts_with("Manipulability") && yaml.has("of")) {
    return "of";
  }
  for (const char* key : {"seen_from", "frame"}) {
    if (yaml.has(key) && message.find("frame '" + yaml.text(key) + "'") != std::string::npos) {
      return key;
    }
  }
  return yaml.has("target") ? "target" : "type";
}

}  // namespace

std::vector<std::string> task_type_names() {
  std::vector<std::string> names;
  for (const auto& [name, reader] : task_readers()) {
    names.push_back(name);
  }
  return names;
}

std::shared_ptr<const Task> read_goal(const YamlReader& yaml, const Robot& robot) {
  try {
    return read_group(yaml, robot, read_rows(yaml, read_by_type(yaml, robot)));
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    if (message.starts_with(yaml.file().string()) || message.starts_with("--set")) {
      throw;
    }
    yaml.fail(blamed_key(yaml, message), message);
  }
}

int read_level(const YamlReader& yaml) {
  const int level = yaml.integer("level");
  if (level < 1) {
    yaml.fail("level", "must be at least 1: limits are above all levels");
  }
  return level;
}

ScenarioTask read_task(const YamlReader& yaml, const Robot& robot) {
  ScenarioTask task;
  task.name = yaml.text("name");
  task.level = read_level(yaml);
  task.task = read_goal(yaml, robot);
  task.tolerance = yaml.positive("tolerance", task.tolerance);
  yaml.finish();
  return task;
}

}  // namespace tope
