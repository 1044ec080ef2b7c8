#include "robot_model.hpp"

#include <tope/robot/robot_terms.hpp>

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/rnea.hpp>

namespace tope {

struct RobotTerms::Scratch {
  explicit Scratch(const Robot& described)
      : robot(described),
        data(model()),
        q(Vector::Zero(robot.nq())),
        v(Vector::Zero(robot.nv())),
        no_acceleration(Vector::Zero(robot.nv())),
        mass_matrix(Matrix::Zero(robot.nv(), robot.nv())) {}

  const pinocchio::Model& model() const { return robot.model().model; }

  Robot robot;  // keeps the shared model alive
  pinocchio::Data data;
  Vector q;
  Vector v;
  Vector no_acceleration;
  Matrix mass_matrix;
};

RobotTerms::RobotTerms(const Robot& robot) : scratch_(std::make_unique<Scratch>(robot)) {
  update(scratch_->q, scratch_->v);
}
RobotTerms::~RobotTerms() = default;
RobotTerms::RobotTerms(RobotTerms&&) noexcept = default;
RobotTerms& RobotTerms::operator=(RobotTerms&&) noexcept = default;

void RobotTerms::update(const VectorArg& q, const VectorArg& v) {
  scratch_->q = q;
  scratch_->v = v;
  pinocchio::computeJointJacobians(scratch_->model(), scratch_->data, scratch_->q);
  pinocchio::updateFramePlacements(scratch_->model(), scratch_->data);
}

void RobotTerms::update_dynamics(const VectorArg& q, const VectorArg& v) {
  Scratch& s = *scratch_;
  s.q = q;
  s.v = v;
  pinocchio::crba(s.model(), s.data, s.q, pinocchio::Convention::WORLD);
  s.mass_matrix = s.data.M.selfadjointView<Eigen::Upper>();  // crba fills the upper triangle alone
  pinocchio::nonLinearEffects(s.model(), s.data, s.q, s.v);
  // last, so that the accelerations in `data` are those without any of the joints'
  pinocchio::forwardKinematics(s.model(), s.data, s.q, s.v, s.no_acceleration);
  pinocchio::computeJointJacobians(s.model(), s.data);
  pinocchio::updateFramePlacements(s.model(), s.data);
}

const Matrix& RobotTerms::mass_matrix() const { return scratch_->mass_matrix; }
const Vector& RobotTerms::bias() const { return scratch_->data.nle; }

Eigen::Matrix<double, 6, 1> RobotTerms::frame_drift(int frame) const {
  return pinocchio::getFrameClassicalAcceleration(scratch_->model(), scratch_->data,
                                                  static_cast<pinocchio::FrameIndex>(frame),
                                                  pinocchio::LOCAL_WORLD_ALIGNED)
      .toVector();
}

const Vector& RobotTerms::position() const { return scratch_->q; }
const Vector& RobotTerms::velocity() const { return scratch_->v; }

const Matrix3& RobotTerms::frame_rotation(int frame) const {
  return scratch_->data.oMf[static_cast<std::size_t>(frame)].rotation();
}

const Vector3& RobotTerms::frame_position(int frame) const {
  return scratch_->data.oMf[static_cast<std::size_t>(frame)].translation();
}

void RobotTerms::frame_jacobian(int frame, Eigen::Ref<Matrix> jacobian) const {
  jacobian.setZero();
  pinocchio::getFrameJacobian(scratch_->model(), scratch_->data, static_cast<pinocchio::FrameIndex>(frame),
                              pinocchio::LOCAL_WORLD_ALIGNED, jacobian);
}

}  // namespace tope
