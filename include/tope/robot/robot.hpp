#pragma once

#include <tope/common/types.hpp>
#include <tope/robot/collision_geometry.hpp>
#include <tope/robot/mecanum_base.hpp>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tope {

struct RobotModel;  // wraps pinocchio::Model, so that no public header includes Pinocchio

/// What a URDF cannot say about a robot.
struct RobotConfig {
  /// Joints held fixed, with their positions [rad or m]; they leave the model, and with them the joints that mimic them.
  std::map<std::string, double> locked_joints;
  /// Rotor inertia seen at the joint, rotor times gear ratio squared [kg m2 or kg].
  std::map<std::string, double> rotor_inertia;
  /// Torque or force bounds that replace the URDF's [Nm or N].
  std::map<std::string, double> effort_limit;
  /// Names of the base joints x, y, yaw, and the wheels under them; none for a robot without mecanum wheels.
  struct Base {
    std::string x;
    std::string y;
    std::string yaw;
    MecanumBaseOptions wheels;
  };
  std::optional<Base> mecanum_base;
  /// The root moves, which the URDF does not say: joints base_x [m], base_y [m] and base_yaw [rad] for a planar base,
  /// base_x, base_y, base_z, base_yaw, base_pitch and base_roll for a floating one. They have one coordinate each, like
  /// all joints, and no position limits but the pitch of a floating base: within 1.4 rad, as yaw and roll become one
  /// at a right angle. Forces act on the base as on a joint: of a robot on legs, contacts are not in the model.
  struct MovingBase {
    enum class Type { planar, floating };
    Type type = Type::planar;
    double speed = 0.0;              ///< bound along each axis [m/s]
    double turn_rate = 0.0;          ///< bound about each axis [rad/s]
    std::optional<double> force{};   ///< bound along each axis [N]; none: unbounded
    std::optional<double> torque{};  ///< bound about each axis [Nm]
  };
  std::optional<MovingBase> base;
  /// Spheres that cover the links, bodies that they keep clear of.
  CollisionGeometry collisions;

  /// Reads a robot's YAML file. Errors: ConfigError with file, line and key.
  static RobotConfig from_yaml(const std::filesystem::path& file);
};

std::string to_string(RobotConfig::MovingBase::Type type);  ///< as in YAML

/// A robot of revolute, continuous and prismatic joints: the kinematic tree, its named joints and their
/// bounds. The model is shared between copies and never changes; the bounds belong to the copy. A continuous
/// joint has one coordinate, its angle, counted past any full turn.
class Robot {
 public:
  /// The URDF's path may start with package://NAME/: see package_path(). Errors: ConfigError for a missing or
  /// malformed URDF, a joint of another kind, a joint that mimics one that moves, an unknown name.
  static Robot from_urdf(const std::filesystem::path& urdf, const RobotConfig& config = {});
  /// The same with the robot's YAML file beside the URDF.
  static Robot from_urdf(const std::filesystem::path& urdf, const std::filesystem::path& config);

  int nq() const { return static_cast<int>(joint_names_.size()); }
  int nv() const { return static_cast<int>(joint_names_.size()); }
  const std::string& name() const { return name_; }

  const std::vector<std::string>& joint_names() const { return joint_names_; }
  /// "rad" or "m".
  const std::string& joint_unit(int joint) const { return joint_units_[static_cast<std::size_t>(joint)]; }
  /// Errors: ConfigError for an unknown name, with the nearest known one.
  int joint_index(const std::string& name) const;
  int frame_index(const std::string& name) const;
  /// True for a frame that no joint moves.
  bool fixed_in_world(int frame) const;
  /// True for frames on one link or on two that a joint connects.
  bool neighbours(int frame, int other) const;
  const std::string& frame_name(int frame) const { return frame_names_[static_cast<std::size_t>(frame)]; }

  /// Bounds of each joint (nv). Infinite where a joint has none.
  const Vector& position_lower() const { return position_lower_; }  ///< [rad or m]
  const Vector& position_upper() const { return position_upper_; }  ///< [rad or m]
  const Vector& velocity_limit() const { return velocity_limit_; }  ///< [rad/s or m/s]
  const Vector& effort_limit() const { return effort_limit_; }      ///< [Nm or N]

  /// Errors: ConfigError for a wrong size, NaN, lower >= upper, or a bound that is not positive.
  void set_position_limits(const Vector& lower, const Vector& upper);
  void set_velocity_limit(const Vector& limit);
  void set_effort_limit(const Vector& limit);
  /// Checks all bounds as the setters do.
  void check_bounds() const;

  const std::optional<MecanumBase>& base() const { return base_; }
  /// How the configuration lets the root move.
  const std::optional<RobotConfig::MovingBase>& moving_base() const { return moving_base_; }
  /// Every joint that is held fixed, with its position [rad or m]: those of the configuration and their mimics.
  const std::map<std::string, double>& locked_joints() const { return locked_joints_; }
  const CollisionGeometry& collisions() const { return collisions_; }
  const RobotModel& model() const { return *model_; }

 private:
  Robot() = default;
  static Robot build(const std::filesystem::path& urdf, const RobotConfig& config, const std::string& where);
  void apply(const RobotConfig& config, const std::string& where);

  std::string name_;
  std::shared_ptr<const RobotModel> model_;
  std::vector<std::string> joint_names_;
  std::vector<std::string> joint_units_;
  std::vector<std::string> frame_names_;
  Vector position_lower_;
  Vector position_upper_;
  Vector velocity_limit_;
  Vector effort_limit_;
  std::optional<MecanumBase> base_;
  std::optional<RobotConfig::MovingBase> moving_base_;
  std::map<std::string, double> locked_joints_;
  CollisionGeometry collisions_;
};

}  // namespace tope
