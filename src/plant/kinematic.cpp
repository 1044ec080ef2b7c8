#include <tope/plant/kinematic.hpp>

namespace tope {

Kinematic::Kinematic(const Robot& robot)
    : position_(Vector::Zero(robot.nq())), velocity_(Vector::Zero(robot.nv())) {}

void Kinematic::reset(const Vector& q) {
  position_ = q;
  velocity_.setZero();
}

void Kinematic::step(const Vector& u, double dt) {
  velocity_ = u;
  position_ += dt * u;
}

}  // namespace tope
