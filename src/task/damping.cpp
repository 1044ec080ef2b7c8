#include <tope/task/damping.hpp>

namespace tope {

// an exponential reference asks for -2 k e' where the error is zero
Damping::Damping(const Robot& robot, double gain) : Task(robot.nv(), robot.nv(), Exponential{0.5 * gain}) {
  jacobian_.setIdentity();
}

}  // namespace tope
