// TSID in C++; configurations and settings as in ../tsid_peer.py.
#include <pinocchio/fwd.hpp>
//
#include "rigid_body.hpp"

#include <memory>
#include <string>
#include <tsid/config.hh>
#include <tsid/formulations/inverse-dynamics-formulation-acc-force.hpp>
#include <tsid/robots/robot-wrapper.hpp>
#include <tsid/solvers/solver-HQP-eiquadprog-fast.hpp>
#include <tsid/tasks/task-actuation-bounds.hpp>
#include <tsid/tasks/task-joint-posVelAcc-bounds.hpp>
#include <tsid/tasks/task-joint-posture.hpp>
#include <tsid/tasks/task-se3-equality.hpp>

namespace {

using peers::Vector;

constexpr double posture_weight = 1e-3;
constexpr double horizon = 0.2;  // s, in which its limits must not be reached

class Tsid {
 public:
  Tsid(const peers::Setup& setup, const std::string& configuration)
      : setup_(setup),
        constrained_(configuration.rfind("orientation-constraint", 0) == 0),
        torque_bounds_(configuration.find("+torque-bounds") != std::string::npos) {}

  double acceleration() const { return constrained_ ? 20.0 : 2.0; }  // rad/s2 or m/s2
  std::string priorities() const {
    return constrained_ ? "orientation a constraint, rest by weights" : "weights 1e4:1";
  }

  void start(const peers::Pose& goal, double dt) {
    const Eigen::Index n = setup_.start.size();
    t_ = 0.0;
    dt_ = dt;
    goal_ = goal;
    formulation_.reset();  // before the tasks it refers to
    robot_ = std::make_unique<tsid::robots::RobotWrapper>(setup_.urdf, std::vector<std::string>{}, false);
    robot_->rotor_inertias(setup_.rotor_inertia);
    robot_->gear_ratios(Vector::Ones(n));
    formulation_ = std::make_unique<tsid::InverseDynamicsFormulationAccForce>("tsid", *robot_, false);
    formulation_->computeProblemData(0.0, setup_.start, Vector::Zero(n));
    orientation_ = frame_task("orientation", goal, 3);
    formulation_->addMotionTask(*orientation_, constrained_ ? 1.0 : peers::orientation_weight,
                                constrained_ ? 0 : 1, 0.0);
    position_ = frame_task("position", goal, 0);
    formulation_->addMotionTask(*position_, 1.0, 1, 0.0);
    add_posture();
    add_limits();
    solver_ = std::make_unique<tsid::solvers::SolverHQuadProgFast>("solver");
    solver_->resize(formulation_->nVar(), formulation_->nEq(), formulation_->nIn());
  }

  void prepare(const Vector& q) {
    if (constrained_) {
      const peers::Matrix3 here = peers::forward(setup_, q).rotation;
      const peers::Matrix3 turned = peers::towards(here, goal_.rotation, peers::near_rad);
      orientation_->setReference(pinocchio::SE3(turned, goal_.position));
    }
  }

  bool command(const Vector& q, const Vector& v, Vector& u) {
    const auto& solution = solver_->solve(formulation_->computeProblemData(t_, q, v));
    t_ += dt_;
    if (solution.status != tsid::solvers::HQP_STATUS_OPTIMAL) {
      return false;
    }
    u = formulation_->getActuatorForces(solution);
    return true;
  }

 private:
  std::unique_ptr<tsid::tasks::TaskSE3Equality> frame_task(const std::string& name, const peers::Pose& goal,
                                                           Eigen::Index first) const {
    auto task = std::make_unique<tsid::tasks::TaskSE3Equality>(name, *robot_, "ee");
    task->Kp(setup_.gain * setup_.gain * Vector::Ones(6));
    task->Kd(2.0 * setup_.gain * Vector::Ones(6));
    task->useLocalFrame(false);
    Vector mask = Vector::Zero(6);
    mask.segment(first, 3).setOnes();
    task->setMask(mask);
    task->setReference(pinocchio::SE3(goal.rotation, goal.position));
    return task;
  }

  void add_posture() {
    const Vector ones = Vector::Ones(setup_.start.size());
    posture_ = std::make_unique<tsid::tasks::TaskJointPosture>("posture", *robot_);
    posture_->Kp(setup_.posture_gain * setup_.posture_gain * ones);
    posture_->Kd(2.0 * setup_.posture_gain * ones);
    tsid::trajectories::TrajectorySample sample(static_cast<unsigned int>(setup_.start.size()));
    sample.setValue(setup_.start);
    posture_->setReference(sample);
    formulation_->addMotionTask(*posture_, posture_weight, 1, 0.0);
  }

  void add_limits() {
    limits_ = std::make_unique<tsid::tasks::TaskJointPosVelAccBounds>("limits", *robot_, horizon, false);
    limits_->setPositionBounds(setup_.lower, setup_.upper);
    limits_->setVelocityBounds(setup_.velocity);
    limits_->setAccelerationBounds(acceleration() * Vector::Ones(setup_.start.size()));
    limits_->setImposeBounds(true, true, true, true);
    formulation_->addMotionTask(*limits_, 1.0, 0, 0.0);
    if (torque_bounds_) {
      bounds_ = std::make_unique<tsid::tasks::TaskActuationBounds>("torque", *robot_);
      bounds_->setBounds(-setup_.effort, setup_.effort);
      formulation_->addActuationTask(*bounds_, 1.0, 0, 0.0);
    }
  }

  const peers::Setup& setup_;
  bool constrained_;
  bool torque_bounds_;
  peers::Pose goal_{};
  double t_ = 0.0;
  double dt_ = 0.0;
  std::unique_ptr<tsid::robots::RobotWrapper> robot_;
  std::unique_ptr<tsid::tasks::TaskSE3Equality> orientation_;
  std::unique_ptr<tsid::tasks::TaskSE3Equality> position_;
  std::unique_ptr<tsid::tasks::TaskJointPosture> posture_;
  std::unique_ptr<tsid::tasks::TaskJointPosVelAccBounds> limits_;
  std::unique_ptr<tsid::tasks::TaskActuationBounds> bounds_;
  std::unique_ptr<tsid::InverseDynamicsFormulationAccForce> formulation_;
  std::unique_ptr<tsid::solvers::SolverHQuadProgFast> solver_;
};

std::string short_text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

}  // namespace

int main(int, char** arguments) {
  const peers::Setup setup = peers::read(arguments[1]);
  Tsid peer(setup, arguments[2]);
  const std::string settings = "k_p " + short_text(setup.gain * setup.gain) + ", k_d " +
                               short_text(2.0 * setup.gain) + ", acceleration bounds " +
                               short_text(peer.acceleration()) + ", horizon of limits " +
                               short_text(horizon) + " s";
  peers::measure(peer, setup, {"tsid", TSID_VERSION, peer.priorities(), settings}, peers::rigid_body(setup));
}
