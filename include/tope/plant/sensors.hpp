#pragma once

#include <tope/common/types.hpp>
#include <tope/robot/robot.hpp>

#include <cstdint>
#include <deque>
#include <random>

namespace tope {

/// What the robot's sensors are like.
struct SensorOptions {
  /// Where the base's pose comes from.
  enum class Localisation {
    ideal,     ///< a localiser that sees the pose itself
    odometry,  ///< the wheels' encoders, added up from the true start: drifts
  };
  Localisation localisation = Localisation::ideal;
  double encoder_noise = 0.0;      ///< standard deviation of joint and wheel angles [rad]
  double encoder_step = 0.0;       ///< their resolution [rad]
  double localiser_noise = 0.0;    ///< standard deviation of the ideal localiser [m and rad]
  double velocity_filter = 0.005;  ///< time constant of the low-pass on differences of positions [s]
  double latency = 0.0;            ///< age of what the controller sees [s], rounded to periods
  std::uint64_t seed = 1;          ///< of the noise
};

/// Encoders of the joints and wheels, and a localiser for the base: turns true positions, once a period, into the state
/// that a controller sees. Velocities are differences of positions behind a low-pass.
class Sensors {
 public:
  /// The robot needs a mecanum base. Errors: ConfigError for an option out of range.
  Sensors(const Robot& robot, const SensorOptions& options, double dt);

  /// Starts at q (nq) with the wheels at these angles [rad], at rest.
  void reset(const Vector& q, const MecanumBase::Wheels& wheels);
  /// The true positions one period later.
  void read(const Vector& q, const MecanumBase::Wheels& wheels);

  const Vector& position() const { return seen_.front().position; }  ///< q (nq)
  const Vector& velocity() const { return seen_.front().velocity; }  ///< v (nv)

 private:
  struct State {
    Vector position;
    Vector velocity;
  };

  double encoder(double angle);
  MecanumBase::Wheels encoders(const MecanumBase::Wheels& angles);
  void locate(const Vector& q, const MecanumBase::Wheels& wheels, Vector& reading);

  SensorOptions options_;
  double dt_;
  MecanumBase base_;
  std::deque<State> seen_;  // oldest first: what the controller sees, ..., the newest
  Eigen::Vector3d odometry_ = Eigen::Vector3d::Zero();
  MecanumBase::Wheels last_wheels_ = MecanumBase::Wheels::Zero();
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace tope
