#include "../reference/target_checks.hpp"

#include <tope/common/error.hpp>
#include <tope/task/center_of_mass.hpp>

#include <utility>

namespace tope {

CenterOfMass::CenterOfMass(const Robot& robot, const Vector3& target, Reference reference)
    : CenterOfMass(robot, Target<PointTarget>(PointTarget{.position = target}), std::move(reference)) {}

CenterOfMass::CenterOfMass(const Robot& robot, Target<PointTarget> target, Reference reference)
    : Task(3, robot.nv(), std::move(reference)), target_(std::move(target)) {
  if (!RobotTerms(robot).com_position().allFinite()) {
    throw ConfigError("CenterOfMass: robot '" + robot.name() +
                      "' has no mass that its joints move; its URDF must give links an <inertial>");
  }
  require_finite("CenterOfMass: target", target_.at(0.0).position);
}

void CenterOfMass::evaluate(const RobotTerms& terms, double t) {
  const PointTarget target = target_.at(t);
  error_ = terms.com_position() - target.position;
  jacobian_ = terms.com_jacobian();
  feedforward_ = target.velocity;
}

void CenterOfMass::evaluate_drift(const RobotTerms& terms, double t) {
  drift_ = terms.com_drift() - target_.at(t).acceleration;
}

}  // namespace tope
