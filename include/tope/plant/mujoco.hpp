#pragma once

#include <tope/plant/plant.hpp>
#include <tope/plant/sensors.hpp>
#include <tope/robot/robot.hpp>

#include <filesystem>
#include <limits>
#include <memory>

namespace tope {

/// A stretch of time [s]; by default none.
struct Interval {
  double start = std::numeric_limits<double>::infinity();
  double duration = std::numeric_limits<double>::infinity();
  bool contains(double t) const { return t >= start && t < start + duration; }
};

/// What goes wrong in a run.
struct MujocoFaults {
  Interval lost_grip{};            ///< a wheel's rollers slide as on ice
  int lost_grip_wheel = 0;         ///< 0 to 3: front left, front right, back left, back right
  Interval stall{};                ///< no new command arrives; the last one stays
  Interval payload{};              ///< a point mass hangs at the end-effector
  double payload_mass = 0.0;       ///< [kg]
  Interval obstacle{};             ///< the obstacle moves along x
  double obstacle_velocity = 0.0;  ///< [m/s]
};

struct MujocoOptions {
  /// What the motors take.
  enum class Drive {
    velocity,  ///< speeds of wheels and joints, by their servos
    torque,    ///< torques of wheels and joints
  };
  std::filesystem::path model;  ///< MJCF file
  Drive drive = Drive::velocity;
  WheelDistribution wheel_distribution = WheelDistribution::minimum_norm;  ///< by torques
  SensorOptions sensors{};
  MujocoFaults faults{};
};

/// The robot in MuJoCo: contacts, rollers, friction, motors, servos and sensors. The base moves by its wheels alone.
///
/// The model must have, by name: one free joint, under the body that the base's three joints place; a hinge for every
/// other joint of the robot; the hinges wheel_fl, wheel_fr, wheel_bl and wheel_br; for each hinge an actuator in group
/// 0 (torque motors) and in group 1 (velocity servos: an actuator with an integrator starts as if it had held the robot
/// before). For faults also a body `payload` next to no mass, and a mocap body `obstacle`.
class Mujoco final : public Plant {
 public:
  /// dt: period of step() [s], cut into equal steps no longer than the model's. Errors: ConfigError for a robot without
  /// a mecanum base, a missing or malformed model, or one that lacks what is said above.
  Mujoco(const Robot& robot, const MujocoOptions& options, double dt);
  ~Mujoco() override;

  void reset(const Vector& q) override;
  /// dt must be the one given at construction. Errors: Error for a command that is not finite, or
  /// when the simulation diverges.
  void step(const Vector& u, double dt) override;
  const Vector& position() const override;
  const Vector& velocity() const override;
  const Vector& measured_position() const override;
  const Vector& measured_velocity() const override;
  /// Mechanical stops of joints [Nm], and bodies of the robot against the obstacle or the floor [N]; wheels may touch
  /// the floor.
  std::map<std::string, double> contacts() const override;

  /// Where the model has a site [m]: more than the joints say, as the base bounces and tilts a little. Errors:
  /// ConfigError for an unknown name.
  Vector3 site_position(const std::string& site) const;

 private:
  struct Simulator;
  std::unique_ptr<Simulator> simulator_;
};

}  // namespace tope
