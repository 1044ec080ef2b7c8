#pragma once

#include "pose_loop.hpp"

#include <controller_interface/controller_interface.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/state.hpp>
#include <realtime_tools/realtime_buffer.hpp>

namespace tope_ros2_example {

/// The ROS part: parameters, the topic of goals, states in and commands out. All thinking is PoseLoop's.
class PoseController final : public controller_interface::ControllerInterface {
 public:
  controller_interface::CallbackReturn on_init() override;
  controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  controller_interface::InterfaceConfiguration state_interface_configuration() const override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State& previous) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State& previous) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State& previous) override;
  controller_interface::return_type update(const rclcpp::Time& time, const rclcpp::Duration& period) override;

 private:
  /// What a message says, of fixed size: copied in the loop without the heap.
  struct Goal {
    bool given = false;
    tope::Vector3 position = tope::Vector3::Zero();
    tope::Matrix3 rotation = tope::Matrix3::Identity();
  };

  void receive(const geometry_msgs::msg::PoseStamped& message);
  bool interfaces_are_in_order() const;
  void read_state();
  bool write(const tope::Vector& velocities);

  std::unique_ptr<PoseLoop> loop_;
  tope::Vector q_;  // (nq), as the state interfaces say
  tope::Vector v_;  // (nv)
  tope::Vector u_;  // (nv), the command
  realtime_tools::RealtimeBuffer<Goal> goal_;
  rclcpp::Subscription<geometry_msgs::msg::PoseStamped>::SharedPtr subscription_;
};

}  // namespace tope_ros2_example
