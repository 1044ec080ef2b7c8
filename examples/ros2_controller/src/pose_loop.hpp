#pragma once

#include <tope/controller/controller.hpp>
#include <tope/task/live_goal.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace tope_ros2_example {

/// What the controller does, without ROS: brings a frame to a pose that may change in any cycle, keeps the joints near
/// where they started otherwise, and stops for good when it cannot trust what it is given.
class PoseLoop {
 public:
  struct Options {
    std::filesystem::path urdf;
    std::filesystem::path config{};  ///< the robot's YAML file; empty: none
    std::string frame = "ee";
    double dt = 1e-3;  ///< period [s]
    int patience = 5;  ///< bad cycles in a row that are borne
  };

  /// Errors: ConfigError for a robot, a frame or a period that will not do.
  explicit PoseLoop(const Options& options);
  PoseLoop(const PoseLoop&) = delete;  // its tasks look at its goal
  PoseLoop& operator=(const PoseLoop&) = delete;

  const tope::Robot& robot() const { return robot_; }

  /// Begins at q (nq): the goal is where the frame is. Allocates, so not for the loop.
  void start(const tope::VectorArg& q);

  /// False for numbers that are no pose: not finite, or no rotation.
  static bool is_pose(const tope::Vector3& position, const tope::Matrix3& rotation) noexcept;
  /// Where the frame is to go. For the loop. Numbers that are no pose change nothing.
  void aim(const tope::Vector3& position, const tope::Matrix3& rotation) noexcept;

  /// One cycle at q (nq), v (nv), `period` [s] after the last: writes the joint velocities u (nv). Never allocates or
  /// throws. False once it has stopped: then u = 0, until the next start().
  [[nodiscard]] bool step(const tope::VectorArg& q, const tope::VectorArg& v, double period,
                          Eigen::Ref<tope::Vector> u) noexcept;

  /// Of the last cycle. Before the first start(): none.
  const tope::Status& status() const { return status_; }

 private:
  Options options_;
  tope::Robot robot_;
  tope::LiveGoal goal_;
  std::optional<tope::Controller> controller_;
  tope::Status status_;
  double time_ = 0.0;
  int bad_cycles_ = 0;
};

}  // namespace tope_ros2_example
