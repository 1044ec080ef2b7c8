#include "mimic_joints.hpp"
#include "moving_base.hpp"
#include "robot_model.hpp"
#include "urdf_loader.hpp"

#include <tope/common/error.hpp>
#include <tope/common/names.hpp>
#include <tope/robot/package_path.hpp>
#include <tope/robot/robot.hpp>

#include <pinocchio/algorithm/model.hpp>
#include <pinocchio/parsers/urdf.hpp>

#include <algorithm>
#include <cmath>

namespace tope {
namespace {

int index_of(const std::string& name, const std::vector<std::string>& names, const std::string& what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw ConfigError("unknown " + what + " '" + name + "'" + name_hint(name, names));
  }
  return static_cast<int>(found - names.begin());
}

pinocchio::Model reduce(const pinocchio::Model& model, const std::map<std::string, double>& locked,
                        const std::string& where) {
  std::vector<pinocchio::JointIndex> indices;
  Eigen::VectorXd reference = Eigen::VectorXd::Zero(model.nq);
  for (const auto& [name, position] : locked) {
    if (!model.existJointName(name)) {
      throw ConfigError(where + ": locked_joints: unknown joint '" + name + "'" +
                        name_hint(name, model.names));
    }
    const pinocchio::JointIndex index = model.getJointId(name);
    indices.push_back(index);
    reference[model.joints[index].idx_q()] = position;
  }
  return indices.empty() ? model : pinocchio::buildReducedModel(model, indices, reference);
}

void check_size(const Vector& values, int size, const std::string& what) {
  if (values.size() != size) {
    throw ConfigError(what + ": expected " + std::to_string(size) + " values, got " +
                      std::to_string(values.size()));
  }
}

void check_position_limits(const Vector& lower, const Vector& upper, const std::vector<std::string>& joints) {
  check_size(lower, static_cast<int>(joints.size()), "position_lower");
  check_size(upper, static_cast<int>(joints.size()), "position_upper");
  for (Eigen::Index j = 0; j < lower.size(); ++j) {
    if (!(lower[j] < upper[j])) {
      throw ConfigError("position limits of " + joints[static_cast<std::size_t>(j)] + ": lower " +
                        std::to_string(lower[j]) + " must be below upper " + std::to_string(upper[j]));
    }
  }
}

void check_positive(const Vector& values, const std::vector<std::string>& joints, const std::string& what) {
  check_size(values, static_cast<int>(joints.size()), what);
  for (Eigen::Index j = 0; j < values.size(); ++j) {
    if (!(values[j] > 0.0)) {
      throw ConfigError(what + ": " + joints[static_cast<std::size_t>(j)] + ": must be positive, got " +
                        std::to_string(values[j]));
    }
  }
}

}  // namespace

Robot Robot::from_urdf(const std::filesystem::path& urdf, const std::filesystem::path& config) {
  return build(urdf, RobotConfig::from_yaml(config), config.string());
}

Robot Robot::from_urdf(const std::filesystem::path& urdf, const RobotConfig& config) {
  return build(urdf, config, urdf.string());
}

Robot Robot::build(const std::filesystem::path& urdf, const RobotConfig& config, const std::string& where) {
  Robot robot;
  const std::filesystem::path file = package_path(urdf);
  const urdf::ModelInterfaceSharedPtr tree = load_urdf(file);
  robot.locked_joints_ = config.locked_joints;
  hold_mimic_joints(file.string(), *tree, robot.locked_joints_);
  if (config.base) {
    add_moving_base(*config.base, where, *tree);
    robot.moving_base_ = config.base;
  }
  pinocchio::Model full;
  pinocchio::urdf::buildModel(tree, full);
  auto shared = std::make_shared<RobotModel>();
  shared->model = reduce(full, robot.locked_joints_, where);
  const pinocchio::Model& model = shared->model;

  robot.name_ = model.name;
  for (pinocchio::JointIndex i = 1; i < static_cast<pinocchio::JointIndex>(model.njoints); ++i) {
    robot.joint_names_.push_back(model.names[i]);
    const bool prismatic = model.joints[i].shortname().find("JointModelP") == 0;
    robot.joint_units_.emplace_back(prismatic ? "m" : "rad");
  }
  if (robot.joint_names_.empty()) {
    throw ConfigError(file.string() + ": the robot has no joint that moves");
  }
  for (const pinocchio::Frame& frame : model.frames) {
    robot.frame_names_.push_back(frame.name);
  }
  robot.model_ = std::move(shared);
  robot.position_lower_ = model.lowerPositionLimit;
  robot.position_upper_ = model.upperPositionLimit;
  robot.velocity_limit_ = model.upperVelocityLimit;
  robot.effort_limit_ = model.upperEffortLimit;
  robot.apply(config, where);
  try {
    robot.check_bounds();
  } catch (const ConfigError& error) {
    throw ConfigError(file.string() + ": " + error.what() +
                      "; correct the URDF (effort_limit can be set in the robot's YAML file)");
  }
  return robot;
}

/// `where` names the file that the configuration came from.
void Robot::apply(const RobotConfig& config, const std::string& where) {
  auto shared = std::make_shared<RobotModel>(*model_);
  const auto joint = [&](const std::string& key, const std::string& name) {
    return index_of(name, joint_names_, where + ": " + key + ": joint");
  };
  for (const auto& [name, inertia] : config.rotor_inertia) {
    shared->model.armature[joint("rotor_inertia", name)] = inertia;
  }
  for (const auto& [name, limit] : config.effort_limit) {
    effort_limit_[joint("effort_limit", name)] = limit;
  }
  if (config.mecanum_base) {
    MecanumBaseOptions wheels = config.mecanum_base->wheels;
    wheels.joints = {joint("mecanum_base", config.mecanum_base->x),
                     joint("mecanum_base", config.mecanum_base->y),
                     joint("mecanum_base", config.mecanum_base->yaw)};
    base_.emplace(wheels);
    const Eigen::Vector3d inertia = base_->reflected_inertia();
    for (int i = 0; i < 3; ++i) {
      shared->model.armature[wheels.joints[static_cast<std::size_t>(i)]] += inertia[i];
    }
  }
  collisions_ = config.collisions;
  model_ = std::move(shared);
}

int Robot::joint_index(const std::string& name) const { return index_of(name, joint_names_, "joint"); }

int Robot::frame_index(const std::string& name) const { return index_of(name, frame_names_, "frame"); }

bool Robot::fixed_in_world(int frame) const {
  return model_->model.frames[static_cast<std::size_t>(frame)].parentJoint == 0;
}

bool Robot::neighbours(int frame, int other) const {
  const pinocchio::Model& model = model_->model;
  const pinocchio::JointIndex one = model.frames[static_cast<std::size_t>(frame)].parentJoint;
  const pinocchio::JointIndex two = model.frames[static_cast<std::size_t>(other)].parentJoint;
  return one == two || model.parents[one] == two || model.parents[two] == one;
}

void Robot::set_position_limits(const Vector& lower, const Vector& upper) {
  check_position_limits(lower, upper, joint_names_);
  position_lower_ = lower;
  position_upper_ = upper;
}

void Robot::set_velocity_limit(const Vector& limit) {
  check_positive(limit, joint_names_, "velocity_limit");
  velocity_limit_ = limit;
}

void Robot::set_effort_limit(const Vector& limit) {
  check_positive(limit, joint_names_, "effort_limit");
  effort_limit_ = limit;
}

void Robot::check_bounds() const {
  check_position_limits(position_lower_, position_upper_, joint_names_);
  check_positive(velocity_limit_, joint_names_, "velocity_limit");
  check_positive(effort_limit_, joint_names_, "effort_limit");
}

}  // namespace tope
