#include "pose_controller.hpp"

#include <tope/common/error.hpp>

#include <Eigen/Geometry>

#include <hardware_interface/types/hardware_interface_type_values.hpp>
#include <limits>
#include <pluginlib/class_list_macros.hpp>
#include <string>

namespace tope_ros2_example {

using controller_interface::CallbackReturn;
using controller_interface::interface_configuration_type;
using controller_interface::InterfaceConfiguration;
using controller_interface::return_type;
using hardware_interface::HW_IF_POSITION;
using hardware_interface::HW_IF_VELOCITY;

CallbackReturn PoseController::on_init() {
  auto_declare<std::string>("urdf", "");
  auto_declare<std::string>("config", "");
  auto_declare<std::string>("frame", "ee");
  auto_declare<int>("patience", 5);
  return CallbackReturn::SUCCESS;
}

// Both are asked for after on_configure(), when the robot is known.
InterfaceConfiguration PoseController::command_interface_configuration() const {
  InterfaceConfiguration interfaces{interface_configuration_type::INDIVIDUAL, {}};
  for (const std::string& joint : loop_->robot().joint_names()) {
    interfaces.names.push_back(joint + "/" + HW_IF_VELOCITY);
  }
  return interfaces;
}

InterfaceConfiguration PoseController::state_interface_configuration() const {
  InterfaceConfiguration interfaces{interface_configuration_type::INDIVIDUAL, {}};
  for (const char* kind : {HW_IF_POSITION, HW_IF_VELOCITY}) {
    for (const std::string& joint : loop_->robot().joint_names()) {
      interfaces.names.push_back(joint + "/" + kind);
    }
  }
  return interfaces;
}

CallbackReturn PoseController::on_configure(const rclcpp_lifecycle::State& /*previous*/) {
  PoseLoop::Options options;
  options.urdf = get_node()->get_parameter("urdf").as_string();
  options.config = get_node()->get_parameter("config").as_string();
  options.frame = get_node()->get_parameter("frame").as_string();
  options.patience = static_cast<int>(get_node()->get_parameter("patience").as_int());
  options.dt = 1.0 / get_update_rate();
  try {
    loop_ = std::make_unique<PoseLoop>(options);
  } catch (const tope::Error& error) {  // the message says where, what, and what would be right
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
    return CallbackReturn::FAILURE;
  }
  q_.setZero(loop_->robot().nq());
  v_.setZero(loop_->robot().nv());
  u_.setZero(loop_->robot().nv());
  subscription_ = get_node()->create_subscription<geometry_msgs::msg::PoseStamped>(
      "~/goal", rclcpp::SystemDefaultsQoS(),
      [this](const geometry_msgs::msg::PoseStamped& message) { receive(message); });
  return CallbackReturn::SUCCESS;
}

CallbackReturn PoseController::on_activate(const rclcpp_lifecycle::State& /*previous*/) {
  if (!interfaces_are_in_order()) {
    RCLCPP_ERROR(get_node()->get_logger(), "interfaces are not in the order that was asked for");
    return CallbackReturn::ERROR;
  }
  goal_.writeFromNonRT(Goal{});  // one from before is none
  read_state();
  try {
    loop_->start(q_);
  } catch (const tope::Error& error) {  // no state yet
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
    return CallbackReturn::ERROR;
  }
  return CallbackReturn::SUCCESS;
}

CallbackReturn PoseController::on_deactivate(const rclcpp_lifecycle::State& /*previous*/) {
  u_.setZero();
  return write(u_) ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
}

/// In the loop: no heap, no lock that waits, no message, nothing thrown.
return_type PoseController::update(const rclcpp::Time& /*time*/, const rclcpp::Duration& period) {
  const Goal& goal = *goal_.readFromRT();
  if (goal.given) {
    loop_->aim(goal.position, goal.rotation);
  }
  read_state();
  const bool goes = loop_->step(q_, v_, period.seconds(), u_);
  return write(u_) && goes ? return_type::OK : return_type::ERROR;
}

/// In the executor's thread. The pose is along the axes of the robot's world, whatever the message's frame says.
void PoseController::receive(const geometry_msgs::msg::PoseStamped& message) {
  const auto& p = message.pose.position;
  const auto& r = message.pose.orientation;
  Goal goal;
  goal.given = true;
  goal.position = {p.x, p.y, p.z};
  goal.rotation = Eigen::Quaterniond(r.w, r.x, r.y, r.z).toRotationMatrix();
  if (PoseLoop::is_pose(goal.position, goal.rotation)) {
    goal_.writeFromNonRT(goal);
  } else {
    RCLCPP_WARN(get_node()->get_logger(), "goal ignored: its numbers are no pose");
  }
}

bool PoseController::interfaces_are_in_order() const {
  const auto same = [](const std::vector<std::string>& names, const auto& interfaces) {
    if (names.size() != interfaces.size()) {
      return false;
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (interfaces[i].get_name() != names[i]) {
        return false;
      }
    }
    return true;
  };
  return same(command_interface_configuration().names, command_interfaces_) &&
         same(state_interface_configuration().names, state_interfaces_);
}

/// A state that cannot be read is no number, which stops the robot.
void PoseController::read_state() {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  const auto joints = static_cast<std::size_t>(q_.size());
  for (std::size_t j = 0; j < joints; ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    q_[at] = state_interfaces_[j].get_optional().value_or(nothing);
    v_[at] = state_interfaces_[joints + j].get_optional().value_or(nothing);
  }
}

bool PoseController::write(const tope::Vector& velocities) {
  bool written = true;
  for (std::size_t j = 0; j < command_interfaces_.size(); ++j) {
    written = command_interfaces_[j].set_value(velocities[static_cast<Eigen::Index>(j)]) && written;
  }
  return written;
}

}  // namespace tope_ros2_example

PLUGINLIB_EXPORT_CLASS(tope_ros2_example::PoseController, controller_interface::ControllerInterface)
