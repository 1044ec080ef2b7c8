#pragma once

#include <tope/plant/plant.hpp>
#include <tope/robot/robot.hpp>

#include <cstdint>
#include <memory>
#include <string>

namespace tope {

/// How far the simulated robot differs from the one that the controller believes in, and how it is integrated.
struct RigidBodyOptions {
  enum class Integrator {
    semi_implicit,  ///< velocity first, then position with the new velocity
    rk4,            ///< Runge-Kutta of fourth order
  };
  Integrator integrator = Integrator::rk4;
  int substeps = 1;            ///< integration steps a period
  bool friction = false;       ///< viscous and dry friction of the joints, as the URDF has them
  double inertia_scale = 1.0;  ///< of every link's mass and inertia
  double payload = 0.0;        ///< point mass [kg] at payload_frame
  std::string payload_frame = "ee";
  double torque_noise = 0.0;  ///< standard deviation, as a share of each joint's effort limit
  std::uint64_t seed = 1;     ///< of the noise
  double delay = 0.0;         ///< the command acts this much later [s], rounded to periods
};

/// A robot under joint torques, by forward dynamics (ABA) with rotor inertia.
class RigidBody final : public Plant {
 public:
  /// dt: period of step() [s]. Errors: ConfigError for an unknown frame or an option out of range.
  RigidBody(const Robot& robot, const RigidBodyOptions& options, double dt);
  ~RigidBody() override;

  /// Starts at q, at rest; until the delay has passed, under the torque that holds it there.
  void reset(const Vector& q) override;
  /// dt must be the one given at construction.
  void step(const Vector& u, double dt) override;
  const Vector& position() const override;
  const Vector& velocity() const override;

  /// Kinetic and potential energy [J], rotors included.
  double energy() const;

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace tope
