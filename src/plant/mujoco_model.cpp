#include "mujoco_model.hpp"

#include "require_base.hpp"

#include <tope/common/error.hpp>
#include <tope/common/names.hpp>

#include <algorithm>
#include <limits>

namespace tope {
namespace {

constexpr std::array<const char*, 4> kWheels{"wheel_fl", "wheel_fr", "wheel_bl", "wheel_br"};
constexpr int kMotors = 0;  // actuator groups
constexpr int kServos = 1;
constexpr int kWithoutMotors = 0b01;  // the bit of a group switches it off
constexpr int kWithoutServos = 0b10;

std::unique_ptr<mjModel, decltype(&mj_deleteModel)> load(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw ConfigError("plant: model: " + file.string() + ": no such file");
  }
  std::array<char, 1000> error{};
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model(
      mj_loadXML(file.c_str(), nullptr, error.data(), static_cast<int>(error.size())), mj_deleteModel);
  if (!model) {
    std::string message = error.data();
    std::replace(message.begin(), message.end(), '\n', ' ');
    throw ConfigError("plant: model: " + file.string() + ": MuJoCo refuses it: " + message);
  }
  return model;
}

int count(const mjModel& model, mjtObj type) {
  switch (type) {
    case mjOBJ_JOINT:
      return static_cast<int>(model.njnt);
    case mjOBJ_SITE:
      return static_cast<int>(model.nsite);
    default:
      return static_cast<int>(model.nbody);
  }
}

// numbers a row of MuJoCo's tables
constexpr std::ptrdiff_t kPair = 2;
constexpr std::ptrdiff_t kGains = mjNGAIN;

}  // namespace

MujocoModel::MujocoModel(const Robot& robot, const MujocoOptions& options)
    : file_(options.model.string()), model_(load(options.model)), wheels_{} {
  const bool torque = options.drive == MujocoOptions::Drive::torque;
  const int group = torque ? kMotors : kServos;
  model_->opt.disableactuator = torque ? kWithoutServos : kWithoutMotors;
  model_->opt.disableflags = mjDSBL_AUTORESET;  // a run that diverges is an error, not a new start
  find_base();
  for (std::size_t i = 0; i < kWheels.size(); ++i) {
    wheels_[i] = find_hinge(kWheels[i], group);
  }
  const auto& base = require_base(robot).options().joints;
  for (int j = 0; j < robot.nv(); ++j) {
    const bool of_base = std::find(base.begin(), base.end(), j) != base.end();
    hinges_.push_back(of_base ? Hinge{-1, -1, -1, {}}
                              : find_hinge(robot.joint_names()[static_cast<std::size_t>(j)], group));
  }
  for (const Hinge& hinge : wheels_) {
    find_integrators(hinge);
  }
  for (const Hinge& hinge : hinges_) {
    find_integrators(hinge);
  }
  assign_geoms();
}

std::unique_ptr<mjData, decltype(&mj_deleteData)> MujocoModel::make_data() const {
  return {mj_makeData(model_.get()), mj_deleteData};
}

bool MujocoModel::part_of_scene(int geom) const {
  const int body = model_->geom_bodyid[geom];
  return body == 0 || model_->body_mocapid[body] >= 0;
}

std::string MujocoModel::owner(int geom) const {
  const int body = model_->geom_bodyid[geom];
  if (wheel_of_geom(geom) >= 0) {
    return kWheels[static_cast<std::size_t>(wheel_of_geom(geom))];
  }
  return body == 0 ? name(mjOBJ_GEOM, geom) : name(mjOBJ_BODY, body);
}

std::string MujocoModel::name(mjtObj type, int index) const {
  const char* name = mj_id2name(model_.get(), type, index);
  return name == nullptr ? std::string(mju_type2Str(type)) + " " + std::to_string(index) : name;
}

int MujocoModel::find(mjtObj type, const std::string& name) const {
  const int index = mj_name2id(model_.get(), type, name.c_str());
  if (index >= 0) {
    return index;
  }
  std::vector<std::string> known;
  known.reserve(static_cast<std::size_t>(count(*model_, type)));
  for (int i = 0; i < count(*model_, type); ++i) {
    known.push_back(this->name(type, i));
  }
  throw ConfigError("plant: model: " + file_ + ": it has no " + mju_type2Str(type) + " '" + name + "'" +
                    name_hint(name, known));
}

void MujocoModel::find_base() {
  for (int joint = 0; joint < model_->njnt; ++joint) {
    if (model_->jnt_type[joint] == mjJNT_FREE) {
      base_q_ = model_->jnt_qposadr[joint];
      base_v_ = model_->jnt_dofadr[joint];
      return;
    }
  }
  throw ConfigError("plant: model: " + file_ + ": it has no free joint, so its base cannot move");
}

MujocoModel::Hinge MujocoModel::find_hinge(const std::string& name, int actuator_group) const {
  const int joint = find(mjOBJ_JOINT, name);
  if (model_->jnt_type[joint] != mjJNT_HINGE) {
    throw ConfigError("plant: model: " + file_ + ": joint '" + name + "' is not a hinge");
  }
  Hinge hinge{joint, model_->jnt_qposadr[joint], model_->jnt_dofadr[joint], {}};
  for (int i = 0; i < model_->nactuator; ++i) {
    if (model_->actuator_group[i] == actuator_group && model_->actuator_trntype[i] == mjTRN_JOINT &&
        model_->actuator_trnid[kPair * i] == joint) {
      hinge.actuators.push_back(i);
    }
  }
  if (hinge.actuators.empty()) {
    throw ConfigError("plant: model: " + file_ + ": joint '" + name + "' has no actuator in group " +
                      std::to_string(actuator_group) +
                      (actuator_group == kMotors ? ", the torque motors" : ", the velocity servos"));
  }
  return hinge;
}

void MujocoModel::find_integrators(const Hinge& hinge) {
  for (const int actuator : hinge.actuators) {
    if (model_->actuator_dyntype[actuator] == mjDYN_INTEGRATOR) {
      const double bound = model_->jnt_actfrclimited[hinge.joint] != 0
                               ? model_->jnt_actfrcrange[kPair * hinge.joint + 1]
                               : std::numeric_limits<double>::infinity();
      integrators_.push_back({.state = model_->actuator_actadr[actuator],
                              .q = hinge.q,
                              .v = hinge.v,
                              .gain = model_->actuator_gainprm[kGains * actuator],
                              .torque_bound = bound});
    }
  }
}

/// A wheel's geoms are those of its body and of the rollers on it.
void MujocoModel::assign_geoms() {
  for (int geom = 0; geom < model_->ngeom; ++geom) {
    int wheel = -1;
    for (int body = model_->geom_bodyid[geom]; body > 0; body = model_->body_parentid[body]) {
      for (int i = 0; i < 4; ++i) {
        wheel = model_->jnt_bodyid[this->wheel(i).joint] == body ? i : wheel;
      }
    }
    geom_wheel_.push_back(wheel);
  }
}

}  // namespace tope
