// What the drives can brake with: against the closed form of a pendulum, as a lower bound over random poses of the
// youBot, and robots whose inertia is missing. Not here: what the conditions make of it (limit room).
#include "support/random.hpp"
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/robot/braking_authority.hpp>
#include <tope/robot/robot_terms.hpp>

#include <Eigen/LU>
#include <boost/test/unit_test.hpp>

#include <string>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(braking)
namespace {

/// A link on a horizontal axis with its mass [kg] half a metre away; `inertial` false: the link has none.
std::string pendulum(double mass, bool inertial = true) {
  const std::string body =
      "<inertial><origin xyz=\"0.5 0 0\"/><mass value=\"" + std::to_string(mass) +
      "\"/><inertia ixx=\"0\" iyy=\"0.02\" izz=\"0\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
  return R"(<robot name="pendulum"><link name="base"/><link name="arm">)" + (inertial ? body : "") +
         R"(</link><joint name="swing" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
            <limit lower="-1.5" upper="1.5" velocity="2" effort="20"/></joint></robot>)";
}

Robot from_text(const std::string& urdf, const RobotConfig& config = {}) {
  const TemporaryFile file("robot.urdf", urdf);
  return Robot::from_urdf(file.path(), config);
}

}  // namespace

BOOST_AUTO_TEST_CASE(pendulum_has_a_closed_form) {
  RobotConfig config;
  config.rotor_inertia["swing"] = 0.1;
  const double inertia = 2.0 * 0.25 + 0.02 + 0.1;
  const double worst = (20.0 - 2.0 * 9.81 * 0.5) / inertia;  // stretched out
  const double found = braking_authority(from_text(pendulum(2.0), config))[0];
  BOOST_TEST(found >= worst - 1e-12);
  BOOST_TEST(found <= worst * 1.001);
}

BOOST_AUTO_TEST_CASE(drive_that_cannot_hold_has_none) {
  BOOST_TEST(braking_authority(from_text(pendulum(5.0)))[0] == 0.0);
}

BOOST_AUTO_TEST_CASE(few_poses_of_the_youbot_are_worse) {
  const Robot robot = youbot();
  const Vector authority = braking_authority(robot);
  RobotTerms terms(robot);
  int worse = 0;
  for (int seed = 0; seed < 500; ++seed) {
    Random random(seed);
    terms.update_dynamics(random_position(random, robot, 0.0), Vector::Zero(8));
    const Matrix inverse = terms.mass_matrix().inverse();
    for (int j = 0; j < 8; ++j) {
      const double here = (robot.effort_limit()[j] - std::abs(terms.bias()[j])) * inverse(j, j);
      BOOST_TEST(here >= 0.93 * authority[j], "seed " << seed << " " << robot.joint_names()[j]);
      worse += here < authority[j] ? 1 : 0;
    }
  }
  BOOST_TEST(worse < 40);  // of 4,000
}

BOOST_AUTO_TEST_CASE(missing_inertia_is_refused_by_name) {
  check_error(
      [] { braking_authority(from_text(pendulum(1.0, false))); },
      {"torque mode needs the inertia of every link", "swing moves no mass", "<inertial>", "rotor_inertia"});
  RobotConfig config;
  config.rotor_inertia["swing"] = 0.1;
  BOOST_TEST(braking_authority(from_text(pendulum(1.0, false), config))[0] == 200.0,
             boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(massless_tip_is_refused_by_name) {
  const std::string tip =
      R"(<link name="tip"/><joint name="wrist" type="revolute"><parent link="arm"/><child link="tip"/>
         <origin xyz="1 0 0"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="2" effort="1"/></joint></robot>)";
  check_error([&] { braking_authority(from_text(replaced(pendulum(1.0), "</robot>", tip))); },
              {"wrist moves no mass"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
