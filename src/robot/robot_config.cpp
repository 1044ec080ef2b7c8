#include "../common/yaml_reader.hpp"
#include "collision_reader.hpp"

#include <tope/common/names.hpp>
#include <tope/robot/robot.hpp>

#include <algorithm>

namespace tope {
namespace {

/// In the order of MovingBase::Type.
const std::vector<std::string>& base_types() {
  static const std::vector<std::string> names{"planar", "floating"};
  return names;
}

std::map<std::string, double> positive_numbers(const YamlReader& yaml, const std::string& key) {
  std::map<std::string, double> values;
  if (!yaml.has(key)) {
    return values;
  }
  const YamlReader entries = yaml.map(key);
  for (const std::string& name : entries.keys()) {
    values[name] = entries.positive(name);
  }
  return values;
}

RobotConfig::Base read_base(const YamlReader& yaml) {
  RobotConfig::Base base;
  const YamlReader joints = yaml.map("joints");
  base.x = joints.text("x");
  base.y = joints.text("y");
  base.yaw = joints.text("yaw");
  joints.finish();
  base.wheels.wheel_radius = yaml.positive("wheel_radius");
  base.wheels.half_wheelbase = yaml.positive("half_wheelbase");
  base.wheels.half_track = yaml.positive("half_track");
  base.wheels.wheel_effort_limit = yaml.positive("wheel_effort_limit");
  base.wheels.wheel_rotor_inertia = yaml.positive("wheel_rotor_inertia");
  yaml.finish();
  return base;
}

RobotConfig::MovingBase read_moving_base(const YamlReader& yaml) {
  const std::string type = yaml.text("type");
  const auto found = std::find(base_types().begin(), base_types().end(), type);
  if (found == base_types().end()) {
    yaml.fail("type", "unknown type of base '" + type + "'" + name_hint(type, base_types()));
  }
  RobotConfig::MovingBase base;
  base.type = static_cast<RobotConfig::MovingBase::Type>(found - base_types().begin());
  base.speed = yaml.positive("speed");
  base.turn_rate = yaml.positive("turn_rate");
  base.force = yaml.optional_positive("force");
  base.torque = yaml.optional_positive("torque");
  yaml.finish();
  return base;
}

}  // namespace

std::string to_string(RobotConfig::MovingBase::Type type) {
  return base_types()[static_cast<std::size_t>(type)];
}

RobotConfig RobotConfig::from_yaml(const std::filesystem::path& file) {
  const YamlReader yaml = YamlReader::load(file);
  RobotConfig config;
  yaml.text("name", "");  // for the reader of the file; the URDF names the robot
  if (yaml.has("locked_joints")) {
    for (const auto& [joint, position] : yaml.numbers("locked_joints")) {
      config.locked_joints[joint] = position;
    }
  }
  config.rotor_inertia = positive_numbers(yaml, "rotor_inertia");
  config.effort_limit = positive_numbers(yaml, "effort_limit");
  if (const auto base = yaml.optional_map("mecanum_base")) {
    config.mecanum_base = read_base(*base);
  }
  if (const auto base = yaml.optional_map("base")) {
    config.base = read_moving_base(*base);
  }
  if (const auto collisions = yaml.optional_map("collisions")) {
    config.collisions = read_collision_geometry(*collisions, "bodies");
    collisions->finish();
  }
  yaml.finish();
  return config;
}

}  // namespace tope
