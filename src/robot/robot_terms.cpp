#include "robot_model.hpp"

#include <tope/robot/robot_terms.hpp>

#include <pinocchio/algorithm/center-of-mass.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/rnea.hpp>

// Pinocchio's algorithms are compiled already for arguments of type VectorArg; for others this file compiles for long.

namespace tope {

struct RobotTerms::Scratch {
  explicit Scratch(const Robot& described)
      : robot(described),
        data(model()),
        q(Vector::Zero(robot.nq())),
        v(Vector::Zero(robot.nv())),
        mass_matrix(Matrix::Zero(robot.nv(), robot.nv())),
        jacobian(Matrix::Zero(6, robot.nv())) {}

  const pinocchio::Model& model() const { return robot.model().model; }

  const pinocchio::Frame& frame(int index) const { return model().frames[static_cast<std::size_t>(index)]; }

  /// Makes `world_T_frame` and `jacobian` those of a frame; tasks on one frame share them.
  void select(int index) {
    if (index == selected) {
      return;
    }
    const pinocchio::Frame& chosen = frame(index);
    world_T_frame = data.oMi[chosen.parentJoint] * chosen.placement;
    jacobian.setZero();  // joints that do not move the frame are left out
    pinocchio::getFrameJacobian(model(), data, static_cast<pinocchio::FrameIndex>(index),
                                pinocchio::LOCAL_WORLD_ALIGNED, jacobian);
    selected = index;
    drift_is_known = false;
  }

  /// Makes `drift` that of the selected frame.
  void find_drift() {
    if (drift_is_known) {
      return;
    }
    const pinocchio::Frame& chosen = frame(selected);
    const pinocchio::JointIndex joint = chosen.parentJoint;
    // a_gf of nonLinearEffects is the acceleration without any of the joints', less gravity
    const pinocchio::Motion joint_acceleration = data.a_gf[joint] + data.oMi[joint].actInv(model().gravity);
    const pinocchio::Motion acceleration = chosen.placement.actInv(joint_acceleration);
    const pinocchio::Motion velocity = chosen.placement.actInv(data.v[joint]);
    const Matrix3& rotation = world_T_frame.rotation();
    drift.head<3>() = rotation * (acceleration.linear() + velocity.angular().cross(velocity.linear()));
    drift.tail<3>() = rotation * acceleration.angular();
    drift_is_known = true;
  }

  /// Makes `data.com`, `data.mass` and `data.Jcom` those of the state.
  void find_centre_of_mass() {
    if (!com_is_known) {
      pinocchio::jacobianCenterOfMass(model(), data, false);
      com_is_known = true;
    }
  }

  void set_state(const VectorArg& position, const VectorArg& velocity) {
    q = position;
    v = velocity;
    selected = -1;
    com_is_known = false;
  }

  Robot robot;  // keeps the shared model alive
  pinocchio::Data data;
  Vector q;
  Vector v;
  Matrix mass_matrix;
  bool com_is_known = false;
  int selected = -1;
  bool drift_is_known = false;
  Eigen::Matrix<double, 6, 1> drift;  // of the selected frame
  pinocchio::SE3 world_T_frame;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;
};

RobotTerms::RobotTerms(const Robot& robot) : scratch_(std::make_unique<Scratch>(robot)) {
  update(scratch_->q, scratch_->v);
}
RobotTerms::~RobotTerms() = default;
RobotTerms::RobotTerms(RobotTerms&&) noexcept = default;
RobotTerms& RobotTerms::operator=(RobotTerms&&) noexcept = default;

void RobotTerms::update(const VectorArg& q, const VectorArg& v) {
  scratch_->set_state(q, v);
  pinocchio::computeJointJacobians(scratch_->model(), scratch_->data, VectorArg(scratch_->q));
}

void RobotTerms::update_dynamics(const VectorArg& q, const VectorArg& v) {
  Scratch& s = *scratch_;
  s.set_state(q, v);
  // the joint Jacobians too
  pinocchio::crba(s.model(), s.data, VectorArg(s.q), pinocchio::Convention::WORLD);
  s.mass_matrix = s.data.M.selfadjointView<Eigen::Upper>();  // crba fills the upper triangle alone
  pinocchio::nonLinearEffects(s.model(), s.data, VectorArg(s.q), VectorArg(s.v));
}

const Matrix& RobotTerms::mass_matrix() const { return scratch_->mass_matrix; }
const Vector& RobotTerms::bias() const { return scratch_->data.nle; }

Eigen::Matrix<double, 6, 1> RobotTerms::frame_drift(int frame) const {
  scratch_->select(frame);
  scratch_->find_drift();
  return scratch_->drift;
}

Vector3 RobotTerms::com_drift() const {
  Scratch& s = *scratch_;
  s.find_centre_of_mass();
  // f of nonLinearEffects is what carries each joint's subtree if no joint accelerates; the trees stand on joint 0
  Vector3 carried = Vector3::Zero();
  for (const pinocchio::JointIndex joint : s.model().children[0]) {
    carried += s.data.oMi[joint].rotation() * s.data.f[joint].linear();
  }
  return carried / s.data.mass[0] + s.model().gravity.linear();
}

Vector3 RobotTerms::com_position() const {
  scratch_->find_centre_of_mass();
  return scratch_->data.com[0];
}

const Eigen::Matrix<double, 3, Eigen::Dynamic>& RobotTerms::com_jacobian() const {
  scratch_->find_centre_of_mass();
  return scratch_->data.Jcom;
}

const Vector& RobotTerms::position() const { return scratch_->q; }
const Vector& RobotTerms::velocity() const { return scratch_->v; }

Matrix3 RobotTerms::frame_rotation(int frame) const {
  scratch_->select(frame);
  return scratch_->world_T_frame.rotation();
}

Vector3 RobotTerms::frame_position(int frame) const {
  scratch_->select(frame);
  return scratch_->world_T_frame.translation();
}

void RobotTerms::frame_jacobian(int frame, Eigen::Ref<Matrix> jacobian) const {
  jacobian = frame_jacobian(frame);
}

const Eigen::Matrix<double, 6, Eigen::Dynamic>& RobotTerms::frame_jacobian(int frame) const {
  scratch_->select(frame);
  return scratch_->jacobian;
}

}  // namespace tope
