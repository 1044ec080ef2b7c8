#include "../robot/robot_model.hpp"

#include <tope/common/error.hpp>
#include <tope/plant/rigid_body.hpp>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <cmath>
#include <deque>
#include <random>

// Pinocchio's algorithms are compiled already for arguments of type VectorArg; for others this file compiles for long.

namespace tope {
namespace {

// dry friction reaches its full size at this speed; a true step would chatter with any integrator [rad/s or m/s]
constexpr double kStiction = 0.01;

void require(bool holds, const std::string& what, double value) {
  if (!holds) {
    throw ConfigError("plant: " + what + ", got " + std::to_string(value));
  }
}

pinocchio::Model perturbed(const Robot& robot, const RigidBodyOptions& options) {
  pinocchio::Model model = robot.model().model;
  for (pinocchio::Inertia& inertia : model.inertias) {
    inertia.mass() *= options.inertia_scale;
    inertia.inertia().data() *= options.inertia_scale;
  }
  if (options.payload > 0.0) {
    const pinocchio::Frame& frame =
        model.frames[static_cast<std::size_t>(robot.frame_index(options.payload_frame))];
    const pinocchio::Inertia point(options.payload, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero());
    model.appendBodyToJoint(frame.parentJoint, point, frame.placement);
  }
  return model;
}

}  // namespace

struct RigidBody::Scratch {
  Scratch(const Robot& robot, const RigidBodyOptions& chosen, double period)
      : options(chosen),
        dt(period),
        model(perturbed(robot, chosen)),
        data(model),
        effort(robot.effort_limit()),
        q(Vector::Zero(robot.nq())),
        v(Vector::Zero(robot.nv())),
        random(chosen.seed) {}

  Vector acceleration(const Vector& position, const Vector& speed, const Vector& torque) {
    Vector applied = torque;
    if (options.friction) {
      applied -= model.damping.cwiseProduct(speed);
      applied -= model.upperDryFrictionLimit.cwiseProduct((speed / kStiction).array().tanh().matrix());
    }
    return pinocchio::aba(model, data, VectorArg(position), VectorArg(speed), VectorArg(applied),
                          pinocchio::Convention::WORLD);
  }

  void semi_implicit(const Vector& torque, double h) {
    v += h * acceleration(q, v, torque);
    q += h * v;
  }

  void runge_kutta(const Vector& torque, double h) {
    const Vector a1 = acceleration(q, v, torque);
    const Vector v2 = v + 0.5 * h * a1;
    const Vector a2 = acceleration(q + 0.5 * h * v, v2, torque);
    const Vector v3 = v + 0.5 * h * a2;
    const Vector a3 = acceleration(q + 0.5 * h * v2, v3, torque);
    const Vector v4 = v + h * a3;
    const Vector a4 = acceleration(q + h * v3, v4, torque);
    q += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }

  Vector delayed(const Vector& torque) {
    queue.push_back(torque);
    Vector oldest = queue.front();
    queue.pop_front();
    return oldest;
  }

  RigidBodyOptions options;
  double dt;
  pinocchio::Model model;
  pinocchio::Data data;
  Vector effort;
  Vector q;
  Vector v;
  std::deque<Vector> queue;
  std::mt19937_64 random;
  std::normal_distribution<double> normal;
};

RigidBody::RigidBody(const Robot& robot, const RigidBodyOptions& options, double dt) {
  require(options.substeps >= 1, "substeps must be at least 1", options.substeps);
  require(options.inertia_scale > 0.0, "inertia_scale must be positive", options.inertia_scale);
  require(options.payload >= 0.0, "payload must not be negative [kg]", options.payload);
  require(options.torque_noise >= 0.0, "torque_noise must not be negative", options.torque_noise);
  require(options.delay >= 0.0 && std::isfinite(options.delay), "delay must not be negative [s]",
          options.delay);
  scratch_ = std::make_unique<Scratch>(robot, options, dt);
}

RigidBody::~RigidBody() = default;

void RigidBody::reset(const Vector& q) {
  Scratch& s = *scratch_;
  s.q = q;
  s.v.setZero();
  const Vector holding = pinocchio::computeGeneralizedGravity(s.model, s.data, VectorArg(q));
  s.queue.assign(static_cast<std::size_t>(std::lround(s.options.delay / s.dt)), holding);
  s.random.seed(s.options.seed);
  s.normal.reset();
}

void RigidBody::step(const Vector& u, double /*dt*/) {
  Scratch& s = *scratch_;
  Vector torque = s.delayed(u);
  if (s.options.torque_noise > 0.0) {
    for (Eigen::Index j = 0; j < torque.size(); ++j) {
      torque[j] += s.options.torque_noise * s.effort[j] * s.normal(s.random);
    }
  }
  const double h = s.dt / s.options.substeps;
  for (int i = 0; i < s.options.substeps; ++i) {
    if (s.options.integrator == RigidBodyOptions::Integrator::rk4) {
      s.runge_kutta(torque, h);
    } else {
      s.semi_implicit(torque, h);
    }
  }
}

const Vector& RigidBody::position() const { return scratch_->q; }
const Vector& RigidBody::velocity() const { return scratch_->v; }

double RigidBody::energy() const {
  Scratch& s = *scratch_;
  // from the mass matrix: Pinocchio 4.1's own kinetic energy misses a part of the rotors'
  pinocchio::crba(s.model, s.data, VectorArg(s.q), pinocchio::Convention::WORLD);
  const Vector momentum = s.data.M.selfadjointView<Eigen::Upper>() * s.v;
  return 0.5 * s.v.dot(momentum) + pinocchio::computePotentialEnergy(s.model, s.data, VectorArg(s.q));
}

}  // namespace tope
