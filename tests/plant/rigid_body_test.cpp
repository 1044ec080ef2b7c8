// The rigid-body plant against what mechanics keeps or Pinocchio computes by other algorithms: energy, momentum,
// M a + h = tau, order of the integrators, payload, delay. Not here: contacts (there are none).
#include "support/robots.hpp"

#include <tope/common/error.hpp>
#include <tope/plant/rigid_body.hpp>
#include <tope/robot/robot_terms.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(rigid_body)
namespace {

constexpr double kPeriod = 1e-3;

Vector folded() {
  Vector q(8);
  q << 0.0, 0.0, 0.2, 0.5, 0.4, 0.9, 0.6, 1.8;
  return q;
}

/// Position after `duration` under constant torque.
Vector run(const Robot& robot, const RigidBodyOptions& options, const Vector& torque, double duration,
           double dt) {
  RigidBody plant(robot, options, dt);
  plant.reset(folded());
  for (auto i = std::lround(duration / dt); i > 0; --i) {
    plant.step(torque, dt);
  }
  return plant.position();
}

}  // namespace

BOOST_AUTO_TEST_CASE(falls_with_constant_energy) {
  const Robot robot = youbot();
  RigidBody plant(robot, {.substeps = 10}, kPeriod);
  plant.reset(folded());
  const double start = plant.energy();
  double largest = 0.0;
  for (int i = 0; i < 500; ++i) {
    plant.step(Vector::Zero(8), kPeriod);
    largest = std::max(largest, std::abs(plant.energy() - start));
  }
  BOOST_TEST(plant.velocity().norm() > 0.5);
  BOOST_TEST(largest <= 1e-8 * std::abs(start));
  BOOST_TEST_MESSAGE("energy " << start << " J, largest change " << largest);
}

BOOST_AUTO_TEST_CASE(keeps_the_momentum_of_its_base) {
  const Robot robot = youbot();
  RigidBody plant(robot, {}, kPeriod);
  plant.reset(folded());
  Vector torque = Vector::Zero(8);
  torque.tail(5) << 1.0, -2.0, 1.0, 0.5, 0.1;  // within the arm: nothing pushes the base
  for (int i = 0; i < 300; ++i) {
    plant.step(torque, kPeriod);
  }
  RobotTerms terms(robot);
  terms.update_dynamics(plant.position(), plant.velocity());
  const Vector momentum = terms.mass_matrix() * plant.velocity();
  BOOST_TEST(plant.velocity().norm() > 0.1);
  BOOST_TEST(momentum.head(2).norm() <= 1e-9);
}

BOOST_AUTO_TEST_CASE(accelerates_as_the_equations_of_motion_say) {
  const Robot robot = youbot();
  RobotTerms terms(robot);
  Random random(3);
  for (int seed = 0; seed < 20; ++seed) {
    const Vector q = random_position(random, robot, 0.1);
    const Vector torque = 5.0 * random.vector(8);
    const double h = 1e-6;
    RigidBody plant(robot, {.integrator = RigidBodyOptions::Integrator::semi_implicit}, h);
    plant.reset(q);
    plant.step(torque, h);
    terms.update_dynamics(q, Vector::Zero(8));
    const Vector acceleration = plant.velocity() / h;
    BOOST_TEST((terms.mass_matrix() * acceleration + terms.bias() - torque).norm() <= 1e-8);
  }
}

BOOST_AUTO_TEST_CASE(integrators_have_their_order) {
  const Robot robot = youbot();
  Vector torque = Vector::Zero(8);
  torque[1] = 5.0;
  using Integrator = RigidBodyOptions::Integrator;
  const Vector exact = run(robot, {.substeps = 8}, torque, 0.4, 0.01);
  const auto error = [&](Integrator integrator, int substeps) {
    return (run(robot, {.integrator = integrator, .substeps = substeps}, torque, 0.4, 0.04) - exact).norm();
  };
  BOOST_TEST(error(Integrator::rk4, 1) > 10.0 * error(Integrator::rk4, 2));
  const double ratio = error(Integrator::semi_implicit, 8) / error(Integrator::semi_implicit, 16);
  BOOST_TEST(std::abs(ratio - 2.0) < 0.3);
}

BOOST_AUTO_TEST_CASE(payload_adds_its_weight) {
  const Robot robot = youbot();
  const double h = 1e-6;
  const auto acceleration = [&](double payload) {
    RigidBody plant(robot, {.integrator = RigidBodyOptions::Integrator::semi_implicit, .payload = payload},
                    h);
    plant.reset(folded());
    plant.step(Vector::Zero(8), h);
    return Vector(plant.velocity() / h);
  };
  RobotTerms terms(robot);
  terms.update_dynamics(folded(), Vector::Zero(8));
  Matrix jacobian(6, 8);
  terms.frame_jacobian(robot.frame_index("ee"), jacobian);
  const Matrix linear = jacobian.topRows(3);
  const Matrix mass = terms.mass_matrix() + 0.5 * linear.transpose() * linear;
  const Vector weight = terms.bias() + 0.5 * 9.81 * linear.row(2).transpose();
  BOOST_TEST((mass * acceleration(0.5) + weight).norm() <= 1e-6);
  BOOST_TEST((mass * acceleration(0.0) + weight).norm() > 0.1);
}

BOOST_AUTO_TEST_CASE(delay_holds_commands_back) {
  const Robot robot = youbot();
  RigidBody plant(robot, {.delay = 3e-3}, kPeriod);
  plant.reset(folded());
  Vector push = Vector::Zero(8);
  push[0] = 10.0;
  for (int i = 0; i < 3; ++i) {
    plant.step(push, kPeriod);
    BOOST_TEST(plant.velocity().norm() <= 1e-9);  // still under the torque that holds it
  }
  plant.step(push, kPeriod);
  BOOST_TEST(plant.velocity()[0] > 1e-5);
}

BOOST_AUTO_TEST_CASE(friction_and_noise_act_and_repeat) {
  const Robot robot = youbot();
  Vector torque = Vector::Zero(8);
  torque[3] = 2.0;
  const Vector free = run(robot, {}, torque, 0.1, kPeriod);
  BOOST_TEST(run(robot, {.friction = true}, torque, 0.1, kPeriod)[3] < free[3]);
  const RigidBodyOptions noisy{.torque_noise = 0.1, .seed = 7};
  BOOST_TEST((run(robot, noisy, torque, 0.1, kPeriod) - free).norm() > 1e-6);
  BOOST_TEST(run(robot, noisy, torque, 0.1, kPeriod) == run(robot, noisy, torque, 0.1, kPeriod));
}

BOOST_AUTO_TEST_CASE(bad_options_are_refused) {
  const Robot robot = youbot();
  BOOST_CHECK_THROW(RigidBody(robot, {.substeps = 0}, kPeriod), ConfigError);
  BOOST_CHECK_THROW(RigidBody(robot, {.inertia_scale = 0.0}, kPeriod), ConfigError);
  BOOST_CHECK_THROW(RigidBody(robot, {.payload = -1.0}, kPeriod), ConfigError);
  BOOST_CHECK_THROW(RigidBody(robot, {.payload = 1.0, .payload_frame = "hand"}, kPeriod), ConfigError);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
