// PotentialField: minus the gradient of its potential by finite differences, its range, and bad options.
// Not here: the level that the field gets (controller room).
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/limit/potential_field.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(potential_field)
namespace {

constexpr double kInfluence = 0.2;
constexpr double kStrength = 0.05;

/// Khatib's potential k influence (1/s - 1)^2 / 2 of every limit, s = distance / influence < 1.
double potential(const Robot& robot, const Vector& q) {
  double sum = 0.0;
  for (int j = 0; j < robot.nq(); ++j) {
    for (const double distance : {robot.position_upper()[j] - q[j], q[j] - robot.position_lower()[j]}) {
      const double s = std::min(1.0, distance / kInfluence);
      sum += 0.5 * kStrength * kInfluence * std::pow(1.0 / s - 1.0, 2);
    }
  }
  return sum;
}

}  // namespace

BOOST_AUTO_TEST_CASE(is_minus_the_gradient_of_its_potential) {
  const Robot robot = youbot();
  PotentialField field(robot, {.influence = kInfluence, .strength = kStrength});
  double largest = 0.0;
  for (int seed = 0; seed < 50; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      Vector q = random_position(random, robot, 0.02);
      q[4] = robot.position_upper()[4] - random.uniform(0.02, 0.25);
      q[7] = robot.position_lower()[7] + random.uniform(0.02, 0.25);
      field.update(q);
      const double h = 1e-7;
      for (int j = 0; j < 8; ++j) {
        Vector ahead = q;
        Vector behind = q;
        ahead[j] += h;
        behind[j] -= h;
        const double slope = (potential(robot, ahead) - potential(robot, behind)) / (2.0 * h);
        const double error = std::abs(field.motion()[j] + slope) / (1.0 + std::abs(slope));
        BOOST_TEST(error <= 1e-6);
        largest = std::max(largest, error);
      }
    }
  }
  BOOST_TEST_MESSAGE("largest relative deviation " << largest);
}

BOOST_AUTO_TEST_CASE(ends_at_its_influence_and_stays_finite) {
  const Robot robot = youbot();
  PotentialField field(robot, {.joints = {"arm_joint_2"}, .influence = kInfluence, .strength = kStrength});
  const auto motion_at = [&](double distance) {
    Vector q = Vector::Zero(8);
    q[4] = robot.position_upper()[4] - distance;
    q[7] = robot.position_upper()[7];  // not among the field's joints
    field.update(q);
    BOOST_TEST(field.motion()[7] == 0.0);
    BOOST_TEST(field.in_range() == (field.motion().norm() > 0.0));
    return field.motion()[4];
  };
  BOOST_TEST(motion_at(0.21) == 0.0);
  BOOST_TEST(motion_at(0.1) < 0.0);
  BOOST_TEST(motion_at(0.05) < motion_at(0.1));
  BOOST_TEST(std::isfinite(motion_at(0.0)));
  BOOST_TEST(motion_at(-0.1) == motion_at(0.0));
  BOOST_TEST(field.repels(4));
  BOOST_TEST(!field.repels(7));
}

BOOST_AUTO_TEST_CASE(bad_options_are_refused) {
  const Robot robot = youbot();
  check_error([&] { PotentialField(robot, {.joints = {"arm_joint_7"}}); }, {"unknown joint 'arm_joint_7'"});
  check_error([&] { PotentialField(robot, {.joints = {"base_yaw"}}); },
              {"potential_field", "base_yaw", "no limit"});
  check_error([&] { PotentialField(robot, {.influence = -0.1}); }, {"potential_field", "positive", "-0.1"});
  check_error([&] { PotentialField(robot, {.strength = NAN}); }, {"potential_field", "positive"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
