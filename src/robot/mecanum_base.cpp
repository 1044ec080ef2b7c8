#include <tope/common/error.hpp>
#include <tope/robot/mecanum_base.hpp>

#include <cmath>

namespace tope {

MecanumBase::MecanumBase(const MecanumBaseOptions& options) : options_(options) {
  if (!(options.wheel_radius > 0.0 && options.half_wheelbase > 0.0 && options.half_track > 0.0)) {
    throw ConfigError("mecanum base: wheel_radius, half_wheelbase and half_track must be positive [m]");
  }
  const double k = options.half_wheelbase + options.half_track;
  wheel_map_ << 1, -1, -k,  //
      1, 1, k,              //
      1, 1, -k,             //
      1, -1, k;
  wheel_map_ /= options.wheel_radius;
}

MecanumBase::Wheels MecanumBase::wheel_speeds(const Eigen::Ref<const Eigen::VectorXd>& v, double yaw) const {
  const double vx = v[options_.joints[0]];
  const double vy = v[options_.joints[1]];
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  const Eigen::Vector3d twist(c * vx + s * vy, -s * vx + c * vy, v[options_.joints[2]]);
  return wheel_map_ * twist;
}

Eigen::Vector3d MecanumBase::reflected_inertia() const {
  return options_.wheel_rotor_inertia * wheel_map_.colwise().squaredNorm().transpose();
}

}  // namespace tope
