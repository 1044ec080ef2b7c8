// Options that torque mode takes from the robot: one that weighs four times as much, with drives as much stronger, gets
// four times the torques, singular poses and lower levels included. Not here: which options suit (docs/parameters.md).
#include "support/random.hpp"
#include "support/text.hpp"

#include <tope/controller/controller.hpp>
#include <tope/robot/heaviest_joint.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/posture.hpp>

#include <boost/test/unit_test.hpp>

#include <string>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(heavy_robots)
namespace {

constexpr double kCarriage = 40.0;  // kg
constexpr double kLink = 2.0;       // kg, each of two

std::string link(const std::string& name, double mass, double inertia) {
  return "<link name=\"" + name + "\"><inertial><origin xyz=\"0.2 0 0\"/><mass value=\"" +
         std::to_string(mass) + "\"/><inertia ixx=\"0\" iyy=\"0\" izz=\"" + std::to_string(inertia) +
         "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, double reach, const std::string& axis, double effort) {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/><origin xyz=\"" + std::to_string(reach) +
         " 0 0\"/><axis xyz=\"" + axis + "\"/><limit lower=\"-2\" upper=\"2\" velocity=\"2\" effort=\"" +
         std::to_string(effort) + "\"/></joint>";
}

/// A carriage on one rail with a planar arm of two links, `scale` times as heavy and as strong.
Robot crane(double scale) {
  const TemporaryFile file(
      "crane.urdf",
      "<robot name=\"crane\"><link name=\"rail\"/>" + link("carriage", scale * kCarriage, 1.0 * scale) +
          link("upper", scale * kLink, 0.125 * scale) + link("lower", scale * kLink, 0.125 * scale) +
          joint("slide", "prismatic", "rail", "carriage", 0.0, "1 0 0", 256.0 * scale) +
          joint("shoulder", "revolute", "carriage", "upper", 0.0, "0 0 1", 64.0 * scale) +
          joint("elbow", "revolute", "upper", "lower", 0.5, "0 0 1", 32.0 * scale) + "</robot>");
  return Robot::from_urdf(file.path(), RobotConfig{});
}

/// The torques of one cycle in a random state, of which the elbow may be stretched.
Vector torques(const Robot& robot, int seed) {
  Random random(seed);
  Controller controller(robot, {.mode = Mode::torque, .dt = 1e-3});
  const Vector3 target = 0.7 * Vector3(random.unit());
  controller.add(1, FramePosition(robot, "lower", target));
  controller.add(2, Posture(robot, random.vector(3, 0.3)));
  Vector q = random.vector(3, 0.5);
  if (random.chance(0.5)) {
    q[1] =
        random.normal() * 0.01;  // the arm along the rail: all joints but the slide move the hand across it
    q[2] = 0.0;
  }
  Vector u(3);
  controller.update(q, random.vector(3, 0.1), 0.0, u);
  return u;
}

}  // namespace

BOOST_AUTO_TEST_CASE(heaviest_joint_of_a_crane_is_its_slide) {
  BOOST_TEST(heaviest_joint(crane(1.0)) == kCarriage + 2.0 * kLink, boost::test_tools::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(options_suit_the_youbot_as_they_stand) {
  const Unilateral::Options light = UnilateralOptions{}.resolved(Mode::torque, 46.0);
  const Unilateral::Options lighter = UnilateralOptions{}.resolved(Mode::torque, 1.0);
  BOOST_TEST(light.lock == lighter.lock);
  BOOST_TEST(light.damping == lighter.damping);
  const Unilateral::Options heavy = UnilateralOptions{.lock = 0.2}.resolved(Mode::torque, 400.0);
  BOOST_TEST(heavy.damping < light.damping);
  BOOST_TEST(heavy.fine_damping <= heavy.damping);
  BOOST_TEST(heavy.lock == 0.2);  // what is set stays
}

BOOST_AUTO_TEST_CASE(torques_grow_with_the_weight) {
  const Robot heavy = crane(4.0);
  const Robot heavier = crane(16.0);
  for (int seed = 0; seed < 50; ++seed) {
    const Vector once = torques(heavy, seed);
    const Vector fourfold = torques(heavier, seed);
    BOOST_TEST((fourfold - 4.0 * once).norm() <= 1e-8 * fourfold.norm(), "seed " << seed);
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
