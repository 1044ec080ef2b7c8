// The sampled-time inequalities: which methods ask for which, their numbers and advice; and that a joint
// driven at full speed stays inside at the longest period they allow. Not here: that a controller enforces
// them (controller room).
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/limit/conditions.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(limit_conditions)
namespace {

constexpr int kJoint = 4;  // arm_joint_2
const Vector kHeadroom = Vector::Constant(8, 0.5);

std::vector<Condition> conditions(const JointLimitOptions& options, LimitMethod method, double dt,
                                  double headroom = 0.01) {
  const Robot robot = youbot();
  return velocity_conditions(robot, JointLimits(robot, options), method, Vector::Constant(8, headroom), dt);
}

const Condition* find(const std::vector<Condition>& list, const std::string& name, const std::string& joint) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const Condition& c) {
    return c.name.find(name) != std::string::npos && c.joint == joint;
  });
  return found == list.end() ? nullptr : &*found;
}

}  // namespace

BOOST_AUTO_TEST_CASE(defaults_are_safe_at_a_kilohertz) {
  for (const std::string& name : limit_method_names()) {
    for (const Condition& condition : conditions({}, limit_method_from(name), 1e-3)) {
      BOOST_TEST(condition.holds(), name << ": " << condition.name << " " << condition.joint);
      BOOST_TEST(condition.margin() == condition.bound - condition.value);
      BOOST_TEST(!condition.advice.empty());
    }
  }
  BOOST_TEST(conditions({}, LimitMethod::none, 1.0).empty());
}

BOOST_AUTO_TEST_CASE(drives_must_be_able_to_brake) {
  const Robot robot = youbot();
  const Vector authority = Vector::Constant(8, 6.0);
  const double v_max = robot.velocity_limit()[kJoint];
  for (const LimitMethod method : {LimitMethod::unilateral, LimitMethod::chain}) {
    const JointLimits strict(robot, {.gain = 5.0, .servo_gain = 10.0});
    const auto list = torque_conditions(robot, strict, method, kHeadroom, 1e-3, authority);
    const Condition* brake = find(list, "brake", "arm_joint_2");
    BOOST_REQUIRE(brake != nullptr);
    const double per_gain = v_max + (method == LimitMethod::chain ? 10.0 * 0.1 : 0.0);
    BOOST_TEST(brake->value == 5.0 * per_gain, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(brake->bound == 6.0);
    BOOST_TEST(!brake->holds());
    BOOST_TEST(brake->advice.find("lower limits.gain to at most") != std::string::npos);

    const double gain = braking_gain(strict, method, kJoint, 6.0);
    BOOST_TEST(gain == 0.8 * 6.0 / per_gain, boost::test_tools::tolerance(1e-12));
    const JointLimits safe(robot, {.gain = gain, .servo_gain = 10.0});
    for (const Condition& condition : torque_conditions(robot, safe, method, kHeadroom, 1e-3, authority)) {
      BOOST_TEST(condition.holds(), condition.name << " " << condition.joint);
    }
  }
  BOOST_TEST(braking_gain(JointLimits(robot, {.servo_gain = 100.0}), LimitMethod::unilateral, kJoint, 1e4) ==
             JointLimits::default_gain);
  BOOST_TEST(braking_gain(JointLimits(robot, {.servo_gain = 4.0}), LimitMethod::unilateral, kJoint, 1e4) ==
             1.6);
  BOOST_TEST(braking_gain(JointLimits(robot, {.buffer = 0.5}), LimitMethod::chain, kJoint, 1e4) ==
             0.9 * v_max / 0.5);
  const int yaw = robot.joint_index("base_yaw");  // without limits
  BOOST_TEST(braking_gain(JointLimits(robot, {}), LimitMethod::unilateral, yaw, 1.0) == 4.0);
}

BOOST_AUTO_TEST_CASE(headroom_suits_the_joint) {
  const Robot robot = youbot();
  const JointLimits limits(robot, {.gain = 0.1});
  const int yaw = robot.joint_index("base_yaw");
  BOOST_TEST(suitable_headroom(limits, yaw, true, 0.5) == 0.5);
  const double range = limits.upper()[kJoint] - limits.lower()[kJoint] - 2e-3;
  BOOST_TEST(suitable_headroom(limits, kJoint, true, 0.5) ==
             0.25 * 10.0 * limits.allowed_speed(kJoint, 0.5 * range));
  BOOST_TEST(suitable_headroom(limits, kJoint, false, 0.5) == 0.25 * 0.1 * range,
             boost::test_tools::tolerance(1e-12));
  BOOST_TEST(suitable_headroom(limits, kJoint, false, 0.01) == 0.01);
  Vector headroom = Vector::Constant(8, 0.5);
  headroom[kJoint] = suitable_headroom(limits, kJoint, true, 0.5);
  const auto list = torque_conditions(robot, limits, LimitMethod::unilateral, headroom, 1e-3, kHeadroom);
  BOOST_TEST(find(list, "headroom", "arm_joint_2")->holds());
}

BOOST_AUTO_TEST_CASE(drives_that_cannot_hold_are_named) {
  const Robot robot = youbot();
  const JointLimits limits(robot, {.gain = 1.0});
  const auto list = torque_conditions(robot, limits, LimitMethod::chain, kHeadroom, 1e-3, Vector::Zero(8));
  const Condition* brake = find(list, "brake", "arm_joint_2");
  BOOST_REQUIRE(brake != nullptr);
  BOOST_TEST(!brake->holds());
  BOOST_TEST(brake->advice.find("cannot hold the robot against gravity") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(unilateral_needs_a_servo_as_fast_as_its_limits) {
  const Robot robot = youbot();
  const auto list = [&](double servo_gain, LimitMethod method) {
    const JointLimits limits(robot, {.gain = 2.0, .servo_gain = servo_gain});
    return torque_conditions(robot, limits, method, 0.1 * kHeadroom, 1e-3, Vector::Constant(8, 1e3));
  };
  const auto slow = list(1.9, LimitMethod::unilateral);
  const Condition* servo = find(slow, "as fast as the limits", "");
  BOOST_REQUIRE(servo != nullptr);
  BOOST_TEST(!servo->holds());
  BOOST_TEST(servo->advice.find("at least 2 1/s") != std::string::npos);
  const auto equal = list(2.0, LimitMethod::unilateral);
  BOOST_TEST(find(equal, "as fast as the limits", "")->holds());
  const auto rows = list(1.9, LimitMethod::chain);
  BOOST_TEST(find(rows, "as fast as the limits", "") == nullptr);
}

BOOST_AUTO_TEST_CASE(servo_must_be_stable) {
  const auto list = conditions({.gain = 10.0}, LimitMethod::chain, 0.2);
  const Condition* servo = find(list, "servo", "");
  BOOST_REQUIRE(servo != nullptr);
  BOOST_TEST(!servo->holds());
  BOOST_TEST(servo->value == 2.0);
  BOOST_TEST(servo->bound == 1.0);
  BOOST_TEST(servo->advice.find("at most 5 1/s") != std::string::npos);
  BOOST_TEST(servo->advice.find("at most 0.1 s") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(buffers_must_be_wide) {
  const double v_max = youbot().velocity_limit()[kJoint];
  for (const Ramp shape : {Ramp::raised_cosine, Ramp::quintic}) {
    const auto list = conditions({.gain = 1.0, .ramp = shape}, LimitMethod::chain, 0.06);
    const Condition* buffer = find(list, "buffer", "arm_joint_2");
    BOOST_REQUIRE(buffer != nullptr);
    BOOST_TEST(buffer->value == ramp_slope_factor(shape) * 0.06 * v_max, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(buffer->bound == 0.1);
    BOOST_TEST(!buffer->holds());
    BOOST_TEST(buffer->advice.find("arm_joint_2") != std::string::npos);
    BOOST_TEST(buffer->advice.find(" rad ") != std::string::npos);
    BOOST_TEST(find(list, "buffer", "base_yaw") == nullptr);  // without limits
  }
}

BOOST_AUTO_TEST_CASE(unilateral_needs_its_headroom_inside_the_bounds) {
  const double v_max = youbot().velocity_limit()[kJoint];
  const auto list = conditions({}, LimitMethod::unilateral, 1e-3, 0.3 * v_max);
  const Condition* headroom = find(list, "headroom", "arm_joint_2");
  BOOST_REQUIRE(headroom != nullptr);
  BOOST_TEST(!headroom->holds());
  BOOST_TEST(headroom->bound == 0.5 * v_max);
  BOOST_TEST(find(list, "buffer", "arm_joint_2") == nullptr);
}

BOOST_AUTO_TEST_CASE(rows_keep_a_joint_inside_at_the_longest_period) {
  // the blended row against a task that drives the joint outwards at full speed, from every place in the
  // buffer
  Robot robot = youbot();
  const double v_max = robot.velocity_limit()[kJoint];
  const double upper = robot.position_upper()[kJoint];
  for (const Ramp shape : {Ramp::raised_cosine, Ramp::quintic}) {
    const JointLimitOptions options{.gain = 2.0, .ramp = shape};
    JointLimits limits(robot, options);
    const auto reach = [&](double dt) {
      double furthest = -INFINITY;
      Vector q = Vector::Zero(8);
      for (int i = 0; i <= 2000; ++i) {
        q[kJoint] = upper - options.buffer * i / 1000.0;
        limits.update(q);
        const double xi = limits.activation()[kJoint];
        const double v = (1.0 - xi) * v_max + xi * limits.target()[kJoint];
        furthest = std::max(furthest, q[kJoint] + dt * v - upper);
      }
      return furthest;
    };
    const double longest = options.buffer / (ramp_slope_factor(shape) * v_max);
    BOOST_TEST(reach(longest) <= 0.0);
    BOOST_TEST(reach(1.3 * longest) > 0.0);  // the inequality is no mere formality
  }
}

BOOST_AUTO_TEST_CASE(bounds_keep_a_joint_inside_at_the_longest_period) {
  Robot robot = youbot();
  const double upper = robot.position_upper()[kJoint];
  const JointLimitOptions options{.gain = 10.0};
  JointLimits limits(robot, options);
  Vector q = Vector::Zero(8);
  for (int i = 0; i <= 2000; ++i) {
    q[kJoint] = upper - 0.4 * i / 2000.0;
    limits.update(q);
    BOOST_TEST(q[kJoint] + limits.motion_upper()[kJoint] / limits.gain(kJoint) <= upper);
  }
}

/// A sphere at the end of a turning link of 0.5 m at 2 rad/s: the centripetal acceleration.
BOOST_AUTO_TEST_CASE(drift_of_a_turning_link_is_centripetal) {
  const TemporaryFile urdf("turn.urdf", R"(<robot name="turn"><link name="base"/><link name="link">
    <inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
    <joint name="turn" type="continuous"><parent link="base"/><child link="link"/><axis xyz="0 0 1"/>
    <limit effort="1" velocity="2"/></joint></robot>)");
  Robot robot = Robot::from_urdf(urdf.path());
  CollisionOptions options;
  options.geometry.spheres = {
      {.name = "tip", .frame = "link", .center = Vector3(0.3, 0.4, 0.7), .radius = 0.1}};
  options.geometry.bodies = {
      {.name = "ball", .shape = shape::Sphere{0.1}, .position = Vector3(2.0, 0.0, 0.0)}};
  CollisionLimits collisions(robot, options, 10.0, 10.0);
  BOOST_TEST(std::abs(full_speed_drift(robot, collisions) - 0.5 * 2.0 * 2.0) <= 1e-12);
  const Condition margin = velocity_conditions(collisions, 2.0, 0.05).back();
  BOOST_TEST(margin.value == 0.5 * 0.05 * 2.0 / 10.0);
  BOOST_TEST(margin.bound == 0.01);
  robot.set_velocity_limit(Vector::Constant(1, std::numeric_limits<double>::infinity()));
  BOOST_TEST(velocity_conditions(collisions, full_speed_drift(robot, collisions), 0.05).size() == 1U);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
