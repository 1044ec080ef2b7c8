#include <tope/robot/heaviest_joint.hpp>
#include <tope/robot/robot_terms.hpp>
#include <tope/robot/sampled_pose.hpp>

namespace tope {

double heaviest_joint(const Robot& robot) {
  RobotTerms terms(robot);
  terms.update_dynamics(sampled_pose(robot, 0), Vector::Zero(robot.nv()));
  return terms.mass_matrix().diagonal().maxCoeff();
}

}  // namespace tope
