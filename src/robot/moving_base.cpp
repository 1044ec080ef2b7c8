#include "moving_base.hpp"

#include <tope/common/error.hpp>

#include <limits>
#include <memory>
#include <vector>

namespace tope {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();
constexpr double pitch_limit = 1.4;  // [rad]

struct Axis {
  const char* joint;
  urdf::Vector3 direction;
  bool turns;
  double limit = unlimited;  // on either side [rad or m]
};

std::vector<Axis> axes(RobotConfig::MovingBase::Type type) {
  const urdf::Vector3 x(1.0, 0.0, 0.0);
  const urdf::Vector3 y(0.0, 1.0, 0.0);
  const urdf::Vector3 z(0.0, 0.0, 1.0);
  if (type == RobotConfig::MovingBase::Type::planar) {
    return {{"base_x", x, false}, {"base_y", y, false}, {"base_yaw", z, true}};
  }
  return {{"base_x", x, false},
          {"base_y", y, false},
          {"base_z", z, false},
          {"base_yaw", z, true},
          {"base_pitch", y, true, pitch_limit},
          {"base_roll", x, true}};
}

urdf::JointSharedPtr make_joint(const Axis& axis, const RobotConfig::MovingBase& base) {
  auto joint = std::make_shared<urdf::Joint>();
  joint->name = axis.joint;
  joint->type = axis.turns ? urdf::Joint::REVOLUTE : urdf::Joint::PRISMATIC;
  joint->axis = axis.direction;
  joint->limits = std::make_shared<urdf::JointLimits>();
  joint->limits->lower = -axis.limit;
  joint->limits->upper = axis.limit;
  joint->limits->velocity = axis.turns ? base.turn_rate : base.speed;
  joint->limits->effort = (axis.turns ? base.torque : base.force).value_or(unlimited);
  return joint;
}

/// Hangs a link under another by a joint.
void connect(const urdf::LinkSharedPtr& parent, const urdf::JointSharedPtr& joint,
             const urdf::LinkSharedPtr& child) {
  joint->parent_link_name = parent->name;
  joint->child_link_name = child->name;
  parent->child_joints.push_back(joint);
  parent->child_links.push_back(child);
  child->parent_joint = joint;
  child->setParent(parent);
}

urdf::LinkSharedPtr add_link(const std::string& name, const std::string& where, urdf::ModelInterface& tree) {
  auto link = std::make_shared<urdf::Link>();
  link->name = name;
  if (!tree.links_.emplace(name, link).second) {
    throw ConfigError(where + ": base: the URDF has a link '" + name +
                      "' already; leave base out if its joints move the base");
  }
  return link;
}

}  // namespace

void add_moving_base(const RobotConfig::MovingBase& base, const std::string& where,
                     urdf::ModelInterface& tree) {
  const urdf::LinkSharedPtr root = tree.root_link_;
  urdf::LinkSharedPtr link = add_link("base_origin", where, tree);
  tree.root_link_ = link;
  const std::vector<Axis> all = axes(base.type);
  for (const Axis& axis : all) {
    const urdf::JointSharedPtr joint = make_joint(axis, base);
    if (!tree.joints_.emplace(joint->name, joint).second) {
      throw ConfigError(where + ": base: the URDF has a joint '" + joint->name +
                        "' already; leave base out if its joints move the base");
    }
    const bool last = &axis == &all.back();
    const urdf::LinkSharedPtr next = last ? root : add_link(joint->name + "_link", where, tree);
    connect(link, joint, next);
    link = next;
  }
}

}  // namespace tope
