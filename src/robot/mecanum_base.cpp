#include <tope/common/error.hpp>
#include <tope/robot/mecanum_base.hpp>

#include <Eigen/Geometry>

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

Eigen::Vector3d MecanumBase::to_base(double x, double y, double turn, double yaw) const {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  return {c * x + s * y, -s * x + c * y, turn};
}

MecanumBase::Wheels MecanumBase::wheel_speeds(const Eigen::Ref<const Eigen::VectorXd>& v, double yaw) const {
  return wheel_map_ * to_base(v[options_.joints[0]], v[options_.joints[1]], v[options_.joints[2]], yaw);
}

Eigen::Vector3d MecanumBase::base_wrench(const Eigen::Ref<const Eigen::VectorXd>& u, double yaw) const {
  return to_base(u[options_.joints[0]], u[options_.joints[1]], u[options_.joints[2]], yaw);
}

Eigen::Vector3d MecanumBase::twist(const Wheels& speeds) const {
  // the columns of the map are orthogonal, so its pseudo-inverse divides by their squared norms
  return (wheel_map_.transpose() * speeds).cwiseQuotient(wheel_map_.colwise().squaredNorm().transpose());
}

Eigen::Vector3d MecanumBase::to_world(const Eigen::Vector3d& motion, double yaw) {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * motion;
}

MecanumBase::Wheels MecanumBase::minimum_norm_torques(const Eigen::Vector3d& wrench) const {
  // orthogonal columns again
  return wheel_map_ * wrench.cwiseQuotient(wheel_map_.colwise().squaredNorm().transpose());
}

MecanumBase::Wheels MecanumBase::minimum_peak_torques(const Eigen::Vector3d& wrench) const {
  const Wheels idle(1.0, 1.0, -1.0, -1.0);
  const Wheels torques = minimum_norm_torques(wrench);
  const Wheels turned = idle.cwiseProduct(torques);
  return torques - 0.5 * (turned.maxCoeff() + turned.minCoeff()) * idle;
}

MecanumBase::Wheels MecanumBase::wheel_torques(const Eigen::Vector3d& wrench,
                                               WheelDistribution distribution) const {
  return distribution == WheelDistribution::minimum_peak ? minimum_peak_torques(wrench)
                                                         : minimum_norm_torques(wrench);
}

Eigen::Vector3d MecanumBase::reflected_inertia() const {
  return options_.wheel_rotor_inertia * wheel_map_.colwise().squaredNorm().transpose();
}

}  // namespace tope
