#include "require_base.hpp"

#include <tope/plant/sensors.hpp>

#include <array>
#include <cmath>

namespace tope {
namespace {

void require_not_negative(const char* option, double value) {
  if (!std::isfinite(value) || value < 0.0) {
    throw ConfigError("plant: sensors: " + std::string(option) + " must not be negative, got " +
                      std::to_string(value));
  }
}

}  // namespace

Sensors::Sensors(const Robot& robot, const SensorOptions& options, double dt)
    : options_(options), dt_(dt), base_(require_base(robot)), random_(options.seed) {
  require_not_negative("encoder_noise", options.encoder_noise);
  require_not_negative("encoder_step", options.encoder_step);
  require_not_negative("localiser_noise", options.localiser_noise);
  require_not_negative("velocity_filter", options.velocity_filter);
  require_not_negative("latency", options.latency);
}

void Sensors::reset(const Vector& q, const MecanumBase::Wheels& wheels) {
  random_.seed(options_.seed);
  normal_.reset();
  for (int i = 0; i < 3; ++i) {
    odometry_[i] = q[base_.options().joints[static_cast<std::size_t>(i)]];
  }
  last_wheels_ = encoders(wheels);
  const State start{.position = q, .velocity = Vector::Zero(q.size())};
  seen_.assign(1 + static_cast<std::size_t>(std::lround(options_.latency / dt_)), start);
}

void Sensors::read(const Vector& q, const MecanumBase::Wheels& wheels) {
  State next = seen_.back();
  Vector reading = q;  // the base's part comes from the localiser
  for (double& angle : reading) {
    angle = encoder(angle);
  }
  locate(q, wheels, reading);
  const double share = dt_ / (options_.velocity_filter + dt_);
  next.velocity += share * ((reading - next.position) / dt_ - next.velocity);
  next.position = reading;
  seen_.push_back(std::move(next));
  seen_.pop_front();
}

double Sensors::encoder(double angle) {
  const double noisy = angle + options_.encoder_noise * normal_(random_);
  return options_.encoder_step > 0.0 ? options_.encoder_step * std::round(noisy / options_.encoder_step)
                                     : noisy;
}

MecanumBase::Wheels Sensors::encoders(const MecanumBase::Wheels& angles) {
  MecanumBase::Wheels readings = angles;
  for (double& angle : readings) {
    angle = encoder(angle);
  }
  return readings;
}

/// Writes the base's pose into the reading.
void Sensors::locate(const Vector& q, const MecanumBase::Wheels& wheels, Vector& reading) {
  const MecanumBase::Wheels angles = encoders(wheels);
  const Eigen::Vector3d moved = base_.twist(angles - last_wheels_);
  last_wheels_ = angles;
  odometry_ += MecanumBase::to_world(moved, odometry_[2] + 0.5 * moved[2]);
  const bool ideal = options_.localisation == SensorOptions::Localisation::ideal;
  for (int i = 0; i < 3; ++i) {
    const int joint = base_.options().joints[static_cast<std::size_t>(i)];
    reading[joint] = ideal ? q[joint] + options_.localiser_noise * normal_(random_) : odometry_[i];
  }
}

}  // namespace tope
