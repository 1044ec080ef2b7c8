// TorqueBounds: every joint's, wheel's and acceleration bound holds, the scale is the largest that keeps them, and the
// wheel maps are inverse to each other, of least norm and of least peak. Not here: CommandBounds (law room).
#include "support/no_allocation.hpp"
#include "support/robots.hpp"

#include <tope/controller/torque_bounds.hpp>

#include <Eigen/Cholesky>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(torque_bounds)
namespace {

constexpr double kWheelBound = 2.137;  // Nm, of the youBot

double wheel_peak(const Robot& robot, WheelDistribution distribution, const Vector& torque, double yaw) {
  const MecanumBase& base = *robot.base();
  const Eigen::Vector3d wrench = base.base_wrench(torque, yaw);
  const MecanumBase::Wheels wheels = distribution == WheelDistribution::minimum_norm
                                         ? base.minimum_norm_torques(wrench)
                                         : base.minimum_peak_torques(wrench);
  return wheels.cwiseAbs().maxCoeff();
}

bool inside(const Robot& robot, WheelDistribution distribution, const Vector& torque, double yaw) {
  return (torque.cwiseAbs() - robot.effort_limit()).maxCoeff() <= 1e-9 &&
         wheel_peak(robot, distribution, torque, yaw) <= kWheelBound + 1e-9;
}

}  // namespace

BOOST_AUTO_TEST_CASE(wheel_torques_give_the_wrench_back) {
  const Robot robot = youbot();
  const MecanumBase& base = *robot.base();
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d wrench = 50.0 * random.vector(3);
    const Eigen::Vector3d speed = random.vector(3);
    for (const MecanumBase::Wheels& torques :
         {base.minimum_norm_torques(wrench), base.minimum_peak_torques(wrench)}) {
      BOOST_TEST((base.wrench(torques) - wrench).norm() <= 1e-12 * (1.0 + wrench.norm()));
      BOOST_TEST(std::abs(torques.dot(base.wheel_map() * speed) - wrench.dot(speed)) <= 1e-12 * 100.0);
    }
  }
}

BOOST_AUTO_TEST_CASE(least_peak_is_that_of_a_search) {
  const Robot robot = youbot();
  const MecanumBase& base = *robot.base();
  const MecanumBase::Wheels idle(1.0, 1.0, -1.0, -1.0);
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d wrench = 50.0 * random.vector(3);
    const MecanumBase::Wheels start = base.minimum_norm_torques(wrench);
    const auto peak = [&](double shift) { return (start + shift * idle).cwiseAbs().maxCoeff(); };
    double low = -10.0;
    double high = 10.0;
    for (int k = 0; k < 200; ++k) {  // the peak is convex in the shift
      const double a = low + (high - low) / 3.0;
      const double b = high - (high - low) / 3.0;
      (peak(a) < peak(b) ? high : low) = peak(a) < peak(b) ? b : a;
    }
    const double least = base.minimum_peak_torques(wrench).cwiseAbs().maxCoeff();
    BOOST_TEST(std::abs(least - peak(low)) <= 1e-12);
    BOOST_TEST(least <= start.cwiseAbs().maxCoeff() + 1e-15);
  }
}

BOOST_AUTO_TEST_CASE(takes_the_largest_scale) {
  const Robot robot = youbot();
  for (const WheelDistribution distribution :
       {WheelDistribution::minimum_norm, WheelDistribution::minimum_peak}) {
    TorqueBounds bounds(robot, distribution);
    for (int seed = 0; seed < 200; ++seed) {
      BOOST_TEST_CONTEXT("seed " << seed) {
        Random random(seed);
        const double yaw = random.uniform(-3.0, 3.0);
        const Vector first = 0.2 * random.vector(8).cwiseProduct(robot.effort_limit());
        const Vector wanted = 3.0 * random.vector(8).cwiseProduct(robot.effort_limit());
        Vector first_torque = first;
        Vector torque = wanted;
        Vector acceleration = Vector::Zero(8);
        if (!inside(robot, distribution, first, yaw)) {
          continue;
        }
        const CommandBounds result =
            bounds.apply(Matrix::Identity(8, 8), yaw, Vector::Zero(8), first_torque, acceleration, torque);
        BOOST_TEST(inside(robot, distribution, torque, yaw));
        BOOST_TEST((torque - (first + result.scale * (wanted - first))).norm() <= 1e-10);
        if (result.scale < 1.0) {
          BOOST_TEST(!inside(robot, distribution, first + (result.scale + 1e-6) * (wanted - first), yaw));
        }
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(clips_what_the_bias_alone_asks_beyond) {
  const Robot robot = youbot();
  TorqueBounds bounds(robot, WheelDistribution::minimum_peak);
  Vector first = 2.0 * robot.effort_limit();
  Vector torque = first;
  Vector acceleration = Vector::Zero(8);
  const CommandBounds result =
      bounds.apply(Matrix::Identity(8, 8), 0.3, Vector::Zero(8), first, acceleration, torque);
  BOOST_TEST(result.clipped >= 0);
  BOOST_TEST(inside(robot, WheelDistribution::minimum_peak, torque, 0.3));
}

BOOST_AUTO_TEST_CASE(joints_that_are_not_clipped_accelerate_as_asked) {
  const Robot robot = youbot();
  TorqueBounds bounds(robot, WheelDistribution::minimum_peak);
  int checked = 0;
  for (int seed = 0; seed < 200; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      const Matrix mass = random.positive_definite(8, 20.0, 60.0);
      Vector first = 0.05 * random.vector(8).cwiseProduct(robot.effort_limit());
      first[0] = random.uniform(1.05, 1.2) * robot.effort_limit()[0];  // the base
      Vector torque = first;
      Vector acceleration = mass.llt().solve(first);
      const Vector wanted = acceleration;
      CommandBounds result;
      {
        const NoAllocation guard("a clipped torque");
        result = bounds.apply(mass, 0.0, wanted, first, acceleration, torque);
      }
      BOOST_TEST(result.clipped >= 0);
      BOOST_TEST(inside(robot, WheelDistribution::minimum_peak, torque, 0.0));
      const Vector reached = mass.llt().solve(torque);
      const bool arm_has_room = (torque.tail(5).cwiseAbs() - robot.effort_limit().tail(5)).maxCoeff() < -1e-6;
      if (arm_has_room) {
        ++checked;
        BOOST_TEST((reached - wanted).tail(5).norm() <= 1e-9 * (1.0 + wanted.norm()));
        BOOST_TEST((reached - wanted).head(3).norm() >= 1e-3);
      }
    }
  }
  BOOST_TEST(checked >= 20);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
