#pragma once

#include <tope/common/types.hpp>
#include <tope/plant/mujoco.hpp>

#include <array>
#include <memory>
#include <mujoco/mujoco.h>
#include <string>
#include <vector>

namespace tope {

/// A loaded MJCF model with the places of a robot's joints, wheels and actuators in it.
class MujocoModel {
 public:
  /// Errors: ConfigError as in Mujoco.
  MujocoModel(const Robot& robot, const MujocoOptions& options);

  mjModel* get() const { return model_.get(); }
  std::unique_ptr<mjData, decltype(&mj_deleteData)> make_data() const;

  /// Index of the object with a name. Errors: ConfigError, with the nearest known name.
  int find(mjtObj type, const std::string& name) const;
  std::string name(mjtObj type, int index) const;

  /// A hinge, and who drives it.
  struct Hinge {
    int joint;                   ///< MuJoCo's index
    int q;                       ///< in qpos
    int v;                       ///< in qvel
    std::vector<int> actuators;  ///< of the group in use
  };
  /// The integral part of a hinge's servo: torque = gain (state - angle).
  struct Integrator {
    int state;  ///< in act
    int q;      ///< in qpos
    int v;      ///< in qvel
    double gain;
    double torque_bound;
  };
  /// Of the actuators in use.
  const std::vector<Integrator>& integrators() const { return integrators_; }
  const Hinge& wheel(int i) const { return wheels_[static_cast<std::size_t>(i)]; }
  /// Of the robot's joint; none (joint < 0) for the three of the base.
  const Hinge& hinge(int robot_joint) const { return hinges_[static_cast<std::size_t>(robot_joint)]; }
  int base_q() const { return base_q_; }  ///< of the free joint in qpos
  int base_v() const { return base_v_; }  ///< in qvel
  /// The wheel that a geom belongs to, or -1.
  int wheel_of_geom(int geom) const { return geom_wheel_[static_cast<std::size_t>(geom)]; }
  /// True for what stands still or moves by a scenario alone: the floor, the obstacle.
  bool part_of_scene(int geom) const;
  /// What a geom belongs to: its wheel, its body, or its own name where that is the world.
  std::string owner(int geom) const;

 private:
  void find_base();
  Hinge find_hinge(const std::string& name, int actuator_group) const;
  void find_integrators(const Hinge& hinge);
  void assign_geoms();

  std::string file_;
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_;
  std::array<Hinge, 4> wheels_;
  std::vector<Hinge> hinges_;
  std::vector<Integrator> integrators_;
  std::vector<int> geom_wheel_;
  int base_q_ = -1;
  int base_v_ = -1;
};

}  // namespace tope
