#pragma once

#include <tope/robot/robot.hpp>

namespace tope {

/// The largest inertia that one joint moves while the others are held: the greatest H_jj in a pose inside the limits
/// [kg or kg m2].
double heaviest_joint(const Robot& robot);

}  // namespace tope
