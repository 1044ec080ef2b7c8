#include "../common/require_positive.hpp"
#include "mujoco_model.hpp"
#include "require_base.hpp"

#include <tope/common/error.hpp>
#include <tope/plant/mujoco.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tope {
namespace {

constexpr double kIce = 0.02;            // friction of a wheel without grip
constexpr double kPayloadRadius = 0.02;  // of the ball that is the payload [m]
constexpr double kSphere = 2.0 / 5.0;    // inertia of a ball over m r^2
constexpr double kStepTolerance = 1e-9;  // of a period that is a whole number of steps
constexpr std::ptrdiff_t kTriple = 3;    // numbers a row of MuJoCo's tables

void require_interval(const char* fault, const Interval& interval) {
  if (std::isnan(interval.start) || !(interval.duration > 0.0)) {
    throw ConfigError("plant: faults: " + std::string(fault) + ": its duration must be positive [s]");
  }
}

}  // namespace

struct Mujoco::Simulator {
  Simulator(const Robot& robot_, const MujocoOptions& options_, double period)
      : robot(robot_),
        options(options_),
        dt(period),
        base(require_base(robot)),
        model(robot, options),
        data(model.make_data()),
        sensors(robot, options.sensors, period),
        command(Vector::Zero(robot.nv())),
        q(Vector::Zero(robot.nq())),
        v(Vector::Zero(robot.nv())),
        stop_force(Vector::Zero(robot.nv())) {
    require_positive("plant: dt", dt);
    mjModel& m = *model.get();
    steps = static_cast<int>(std::ceil(dt / m.opt.timestep - kStepTolerance));
    m.opt.timestep = dt / steps;
    friction.assign(m.geom_friction, m.geom_friction + kTriple * m.ngeom);
    check_faults();
  }

  void check_faults() {
    const MujocoFaults& faults = options.faults;
    require_interval("lost_grip", faults.lost_grip);
    require_interval("stall", faults.stall);
    require_interval("payload", faults.payload);
    require_interval("obstacle", faults.obstacle);
    if (std::isfinite(faults.payload.start)) {
      require_positive("plant: faults: payload: mass", faults.payload_mass);
      payload_body = model.find(mjOBJ_BODY, "payload");
    }
    if (std::isfinite(faults.obstacle.start)) {
      obstacle_mocap = model.get()->body_mocapid[model.find(mjOBJ_BODY, "obstacle")];
      if (obstacle_mocap < 0) {
        throw ConfigError("plant: model: " + options.model.string() +
                          ": body 'obstacle' is not a mocap body");
      }
    }
  }

  /// Of x, y and yaw.
  int base_joint(int i) const { return base.options().joints[static_cast<std::size_t>(i)]; }

  void place(const Vector& start) {
    mj_resetData(model.get(), data.get());
    mjtNum* pose = data->qpos + model.base_q();
    const double yaw = start[base_joint(2)];
    pose[0] = start[base_joint(0)];
    pose[1] = start[base_joint(1)];
    pose[3] = std::cos(0.5 * yaw);
    pose[4] = pose[5] = 0.0;
    pose[6] = std::sin(0.5 * yaw);
    for (int j = 0; j < robot.nv(); ++j) {
      if (model.hinge(j).joint >= 0) {
        data->qpos[model.hinge(j).q] = start[j];
      }
    }
    q = start;
    v.setZero();
  }

  /// Integrators start at the torques that hold the arm.
  void hold() {
    mj_forward(model.get(), data.get());
    for (const MujocoModel::Integrator& integrator : model.integrators()) {
      data->act[integrator.state] =
          data->qpos[integrator.q] + data->qfrc_bias[integrator.v] / integrator.gain;
    }
  }

  /// No integrator runs ahead of what its motor can give.
  void stop_windup() {
    for (const MujocoModel::Integrator& integrator : model.integrators()) {
      const double lead = integrator.torque_bound / integrator.gain;
      const double angle = data->qpos[integrator.q];
      data->act[integrator.state] = std::clamp(data->act[integrator.state], angle - lead, angle + lead);
    }
  }

  void drive(const MujocoModel::Hinge& hinge, double value) {
    for (const int actuator : hinge.actuators) {
      data->ctrl[model.get()->actuator_ctrladr[actuator]] = value;
    }
  }

  /// Gives the command to the motors as the robot's own drives would: with what it knows of its heading.
  void drive_all() {
    const double yaw = sensors.position()[base_joint(2)];
    const MecanumBase::Wheels wheels =
        options.drive == MujocoOptions::Drive::velocity
            ? base.wheel_speeds(command, yaw)
            : base.wheel_torques(base.base_wrench(command, yaw), options.wheel_distribution);
    for (int i = 0; i < 4; ++i) {
      drive(model.wheel(i), wheels[i]);
    }
    for (int j = 0; j < robot.nv(); ++j) {
      drive(model.hinge(j), command[j]);
    }
  }

  void apply_faults() {
    const MujocoFaults& faults = options.faults;
    set_grip(faults.lost_grip.contains(data->time));
    set_payload(faults.payload.contains(data->time));
    if (faults.obstacle.contains(data->time)) {
      data->mocap_pos[kTriple * obstacle_mocap] += faults.obstacle_velocity * model.get()->opt.timestep;
    }
  }

  void set_grip(bool lost) {
    if (lost == grip_lost) {
      return;
    }
    grip_lost = lost;
    for (int geom = 0; geom < model.get()->ngeom; ++geom) {
      if (model.wheel_of_geom(geom) == options.faults.lost_grip_wheel) {
        const std::ptrdiff_t slide = kTriple * geom;
        model.get()->geom_friction[slide] = lost ? kIce : friction[static_cast<std::size_t>(slide)];
      }
    }
  }

  void set_payload(bool held) {
    if (held == payload_held) {
      return;
    }
    payload_held = held;
    const double mass = held ? options.faults.payload_mass : -options.faults.payload_mass;
    model.get()->body_mass[payload_body] += mass;
    for (int i = 0; i < 3; ++i) {
      model.get()->body_inertia[kTriple * payload_body + i] +=
          kSphere * mass * kPayloadRadius * kPayloadRadius;
    }
    const auto scratch = model.make_data();  // the model's derived constants need a state to work in
    mj_setConst(model.get(), scratch.get());
  }

  void note_contacts() {
    for (int row = 0; row < data->nefc; ++row) {
      if (data->efc_type[row] == mjCNSTR_LIMIT_JOINT) {
        note_stop(data->efc_id[row], data->efc_force[row]);
      }
    }
    for (int i = 0; i < data->ncon; ++i) {
      note_touch(i);
    }
  }

  void note_stop(int joint, double force) {
    for (int j = 0; j < robot.nv(); ++j) {
      if (model.hinge(j).joint == joint) {
        stop_force[j] = std::max(stop_force[j], force);
      }
    }
  }

  void note_touch(int contact) {
    const int first = data->contact[contact].geom[0];
    const int second = data->contact[contact].geom[1];
    const bool in_order = model.part_of_scene(second);
    const int of_robot = in_order ? first : second;
    const int touched = in_order ? second : first;
    const bool on_floor = model.get()->geom_type[touched] == mjGEOM_PLANE;
    if (model.wheel_of_geom(of_robot) >= 0 && on_floor) {
      return;  // it rolls
    }
    std::array<mjtNum, 6> force{};
    mj_contactForce(model.get(), data.get(), contact, force.data());
    double& largest = touches[{of_robot, touched}];
    largest = std::max(largest, force[0]);
  }

  void advance() {
    for (int i = 0; i < steps; ++i) {
      apply_faults();
      mj_step(model.get(), data.get());
      stop_windup();
      note_contacts();
    }
    for (const mjtWarning warning : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC, mjWARN_BADCTRL}) {
      if (data->warning[warning].number > 0) {
        throw Error("plant: MuJoCo's simulation diverged at " + std::to_string(data->time) +
                    " s: " + mju_warningText(warning, data->warning[warning].lastinfo));
      }
    }
  }

  void read_state() {
    const mjtNum* pose = data->qpos + model.base_q();
    const mjtNum* speed = data->qvel + model.base_v();
    const double last_yaw = q[base_joint(2)];
    const Matrix3 rotation = Eigen::Quaterniond(pose[3], pose[4], pose[5], pose[6]).toRotationMatrix();
    const double heading = std::atan2(rotation(1, 0), rotation(0, 0));
    for (int i = 0; i < 2; ++i) {
      q[base_joint(i)] = pose[i];
      v[base_joint(i)] = speed[i];
    }
    // past any full turn
    q[base_joint(2)] = last_yaw + std::remainder(heading - last_yaw, 2.0 * std::numbers::pi);
    v[base_joint(2)] = rotation.row(2).dot(Eigen::Map<const Vector3>(speed + 3));
    for (int j = 0; j < robot.nv(); ++j) {
      if (model.hinge(j).joint >= 0) {
        q[j] = data->qpos[model.hinge(j).q];
        v[j] = data->qvel[model.hinge(j).v];
      }
    }
  }

  MecanumBase::Wheels wheel_angles() const {
    MecanumBase::Wheels angles;
    for (int i = 0; i < 4; ++i) {
      angles[i] = data->qpos[model.wheel(i).q];
    }
    return angles;
  }

  Robot robot;
  MujocoOptions options;
  double dt;
  MecanumBase base;
  MujocoModel model;
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data;
  Sensors sensors;
  int steps = 1;  // a period
  Vector command;
  Vector q;
  Vector v;
  int payload_body = -1;
  int obstacle_mocap = -1;
  bool grip_lost = false;
  bool payload_held = false;
  std::vector<double> friction;                   // of every geom in the model as it was loaded
  Vector stop_force;                              // largest, of each joint
  std::map<std::pair<int, int>, double> touches;  // largest force between two geoms
};

Mujoco::Mujoco(const Robot& robot, const MujocoOptions& options, double dt)
    : simulator_(std::make_unique<Simulator>(robot, options, dt)) {}

Mujoco::~Mujoco() = default;

void Mujoco::reset(const Vector& q) {
  Simulator& s = *simulator_;
  s.set_grip(false);
  s.set_payload(false);
  s.place(q);
  s.hold();
  s.command.setZero();
  s.stop_force.setZero();
  s.touches.clear();
  s.sensors.reset(q, s.wheel_angles());
}

void Mujoco::step(const Vector& u, double /*dt*/) {
  Simulator& s = *simulator_;
  if (!u.allFinite()) {
    throw Error("plant: the command is not finite");
  }
  if (!s.options.faults.stall.contains(s.data->time)) {
    s.command = u;
  }
  s.drive_all();
  s.advance();
  s.read_state();
  s.sensors.read(s.q, s.wheel_angles());
}

const Vector& Mujoco::position() const { return simulator_->q; }
const Vector& Mujoco::velocity() const { return simulator_->v; }
const Vector& Mujoco::measured_position() const { return simulator_->sensors.position(); }
const Vector& Mujoco::measured_velocity() const { return simulator_->sensors.velocity(); }

std::map<std::string, double> Mujoco::contacts() const {
  const Simulator& s = *simulator_;
  std::map<std::string, double> largest;
  for (int j = 0; j < s.robot.nv(); ++j) {
    if (s.stop_force[j] > 0.0) {
      largest[s.robot.joint_names()[static_cast<std::size_t>(j)] + " at its stop"] = s.stop_force[j];
    }
  }
  for (const auto& [geoms, force] : s.touches) {
    double& entry = largest[s.model.owner(geoms.first) + " on " + s.model.owner(geoms.second)];
    entry = std::max(entry, force);
  }
  return largest;
}

Vector3 Mujoco::site_position(const std::string& site) const {
  const Simulator& s = *simulator_;
  const int index = s.model.find(mjOBJ_SITE, site);
  // mj_step leaves the sites where they were before its last step
  mj_kinematics(s.model.get(), s.data.get());
  return Eigen::Map<const Vector3>(s.data->site_xpos + kTriple * index);
}

}  // namespace tope
