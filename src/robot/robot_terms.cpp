#include "robot_model.hpp"

#include <tope/robot/robot_terms.hpp>

#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>

namespace tope {

struct RobotTerms::Scratch {
  explicit Scratch(const Robot& described)
      : robot(described), data(model()), q(Vector::Zero(robot.nq())), v(Vector::Zero(robot.nv())) {}

  const pinocchio::Model& model() const { return robot.model().model; }

  Robot robot;  // keeps the shared model alive
  pinocchio::Data data;
  Vector q;
  Vector v;
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
