#include "task_reader.hpp"

#include <tope/common/names.hpp>
#include <tope/task/center_of_mass.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_pose.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_position.hpp>
#include <tope/task/pointing.hpp>
#include <tope/task/posture.hpp>
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
  const Vector3 position = yaml.vector("position", 3);
  if (yaml.has("velocity")) {
    return moving_along_line(position, yaml.vector("velocity", 3));
  }
  if (yaml.has("amplitude")) {
    return moving_along_sine(position, yaml.vector("amplitude", 3), yaml.positive("frequency"));
  }
  return PointTarget{.position = position};
}

/// The target of a task that is about a point alone.
Target<PointTarget> read_point_target(const YamlReader& yaml) {
  const YamlReader target = yaml.map("target");
  Target<PointTarget> point = read_point(target);
  target.finish();
  return point;
}

Target<RotationTarget> read_rotation(const YamlReader& yaml) {
  const Matrix3 rotation = yaml.rotation("quaternion");
  if (yaml.has("angular_velocity")) {
    return spinning(rotation, yaml.vector("angular_velocity", 3));
  }
  return RotationTarget{.rotation = rotation};
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
  target.finish();
  return task;
}

std::shared_ptr<const Task> read_pose(const YamlReader& yaml, const Robot& robot) {
  const YamlReader target = yaml.map("target");
  auto task = std::make_shared<FramePose>(robot, yaml.text("frame"), read_point(target),
                                          read_rotation(target), read_reference(yaml));
  target.finish();
  return task;
}

std::shared_ptr<const Task> read_pointing(const YamlReader& yaml, const Robot& robot) {
  return std::make_shared<Pointing>(robot, yaml.text("frame"), Vector3(yaml.vector("axis", 3)),
                                    read_point_target(yaml), read_reference(yaml));
}

std::shared_ptr<const Task> read_center_of_mass(const YamlReader& yaml, const Robot& robot) {
  return std::make_shared<CenterOfMass>(robot, read_point_target(yaml), read_reference(yaml));
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
      {"frame_position", read_position}, {"frame_orientation", read_orientation}, {"frame_pose", read_pose},
      {"posture", read_posture},         {"joint_position", read_joints},         {"damping", read_damping},
      {"pointing", read_pointing},       {"center_of_mass", read_center_of_mass},
  };
  return readers;
}

std::shared_ptr<const Task> read_by_type(const YamlReader& yaml, const Robot& robot) {
  const std::string type = yaml.text("type");
  std::vector<std::string> names;
  for (const auto& [name, reader] : task_readers()) {
    if (name == type) {
      return reader(yaml, robot);
    }
    names.push_back(name);
  }
  yaml.fail("type", "unknown task '" + type + "'" + name_hint(type, names));
}

/// Of any task, `rows` keeps those alone.
std::shared_ptr<const Task> read_rows(const YamlReader& yaml, std::shared_ptr<const Task> task) {
  if (!yaml.has("rows")) {
    return task;
  }
  const Vector numbers = yaml.vector("rows", -1);
  if ((numbers.array() != numbers.array().round()).any() || numbers.lpNorm<Eigen::Infinity>() > 1e6) {
    yaml.fail("rows", "expected whole numbers, counted from 0");
  }
  const std::vector<int> rows(numbers.begin(), numbers.end());
  return std::make_shared<SelectedRows>(*task, rows);
}

/// The key that an error of a task's constructor is about, as far as its words tell.
std::string blamed_key(const YamlReader& yaml, const std::string& message) {
  if (message.starts_with("SelectedRows")) {
    return "rows";
  }
  if (message.starts_with("Pointing: axis")) {
    return "axis";
  }
  if (message.find("frame") != std::string::npos && yaml.has("frame")) {
    return "frame";
  }
  return yaml.has("target") ? "target" : "type";
}

}  // namespace

ScenarioTask read_task(const YamlReader& yaml, const Robot& robot) {
  ScenarioTask task;
  task.name = yaml.text("name");
  task.level = yaml.integer("level");
  if (task.level < 1) {
    yaml.fail("level", "must be at least 1: limits are above all levels");
  }
  try {
    task.task = read_rows(yaml, read_by_type(yaml, robot));
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    if (message.starts_with(yaml.file().string()) || message.starts_with("--set")) {
      throw;
    }
    yaml.fail(blamed_key(yaml, message), message);
  }
  task.tolerance = yaml.positive("tolerance", task.tolerance);
  yaml.finish();
  return task;
}

}  // namespace tope
