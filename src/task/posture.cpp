#include "../reference/target_checks.hpp"

#include <tope/common/error.hpp>
#include <tope/task/posture.hpp>

#include <utility>

namespace tope {

Posture::Posture(const Robot& robot, const Vector& target, Reference reference)
    : Task(robot.nv(), robot.nv(), std::move(reference)), target_(target) {
  if (target.size() != robot.nq()) {
    throw ConfigError("Posture: target: expected " + std::to_string(robot.nq()) + " values, got " +
                      std::to_string(target.size()));
  }
  require_finite("Posture: target", target_);
  jacobian_.setIdentity();
}

void Posture::evaluate(const RobotTerms& terms, double /*t*/) { error_ = terms.position() - target_; }

}  // namespace tope
