#include <tope/task/damping.hpp>

namespace tope {

Damping::Damping(const Robot& robot) : Task(robot.nv(), robot.nv(), Exponential{}) {
  jacobian_.setIdentity();
}

}  // namespace tope
