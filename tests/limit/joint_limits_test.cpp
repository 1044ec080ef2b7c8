// JointLimits: rows, activations and bounds at the buffer's edge, at the limit, beyond it and without one;
// engagement; bad options. Not here: that they keep a joint inside over time
// (conditions_test, controller room).
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/limit/joint_limits.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {
namespace joint_limits {

constexpr int kJoint = 4;  // arm_joint_2: [-1.117011, 1.553343] rad, 1.570796 rad/s
constexpr int kYaw = 2;    // without limits

struct Fixture {
  Robot robot = youbot();
  JointLimitOptions options{.buffer = 0.1, .buffers = {{"arm_joint_1", 0.2}}, .gain = 8.0};
  JointLimits limits{robot, options};
  double upper = robot.position_upper()[kJoint];
  double lower = robot.position_lower()[kJoint];
  double v_max = robot.velocity_limit()[kJoint];

  /// Updates with the joint at `position`, the others at zero.
  void move(double position) {
    Vector q = Vector::Zero(8);
    q[kJoint] = position;
    limits.update(q);
  }
};

constexpr auto near = [](double a, double b) { return std::abs(a - b) <= 1e-12; };

}  // namespace joint_limits

BOOST_FIXTURE_TEST_SUITE(joint_limits, Fixture)

BOOST_AUTO_TEST_CASE(rows_follow_the_buffer) {
  move(0.0);
  BOOST_TEST(limits.activation()[kJoint] == 0.0);
  move(upper - 0.1);  // inner edge
  BOOST_TEST(near(limits.activation()[kJoint], 0.0));
  BOOST_TEST(near(limits.target()[kJoint], 0.0));
  move(upper - 0.05);
  BOOST_TEST(near(limits.activation()[kJoint], 0.5));
  BOOST_TEST(near(limits.target()[kJoint], -8.0 * 0.05));
  move(upper);
  BOOST_TEST(limits.activation()[kJoint] == 1.0);
  BOOST_TEST(near(limits.target()[kJoint], -8.0 * 0.1));
  BOOST_TEST(limits.beyond() == -1);
  move(upper + 0.02);
  BOOST_TEST(limits.activation()[kJoint] == 1.0);
  BOOST_TEST(near(limits.target()[kJoint], -8.0 * 0.12));
  BOOST_TEST(limits.beyond() == kJoint);
  move(lower + 0.05);
  BOOST_TEST(near(limits.activation()[kJoint], 0.5));
  BOOST_TEST(near(limits.target()[kJoint], 8.0 * 0.05));
  move(lower - 0.02);
  BOOST_TEST(near(limits.target()[kJoint], 8.0 * 0.12));
  BOOST_TEST(limits.beyond() == kJoint);
}

BOOST_AUTO_TEST_CASE(bounds_follow_the_distance) {
  const double m = options.margin;
  move(0.0);
  BOOST_TEST(limits.motion_upper()[kJoint] == v_max);
  BOOST_TEST(limits.motion_lower()[kJoint] == -v_max);
  move(upper - 0.05);
  BOOST_TEST(near(limits.motion_upper()[kJoint], 8.0 * (0.05 - m)));
  BOOST_TEST(limits.motion_lower()[kJoint] == -v_max);
  move(upper - m);
  BOOST_TEST(near(limits.motion_upper()[kJoint], 0.0));
  move(upper);
  BOOST_TEST(near(limits.motion_upper()[kJoint], -8.0 * m));  // leads back into the margin
  move(upper + 1.0);
  BOOST_TEST(limits.motion_upper()[kJoint] == -0.5 * v_max);
  BOOST_TEST(limits.motion_lower()[kJoint] == -v_max);
  move(lower + 0.05);
  BOOST_TEST(near(limits.motion_lower()[kJoint], -8.0 * (0.05 - m)));
  move(lower - 1.0);
  BOOST_TEST(limits.motion_lower()[kJoint] == 0.5 * v_max);
  BOOST_TEST(limits.motion_upper()[kJoint] == v_max);
}

BOOST_AUTO_TEST_CASE(a_joint_without_limits_keeps_its_speed_bound_alone) {
  Vector q = Vector::Zero(8);
  q[kYaw] = 1e4;
  limits.update(q);
  BOOST_TEST(!limits.limited(kYaw));
  BOOST_TEST(limits.activation()[kYaw] == 0.0);
  BOOST_TEST(limits.target()[kYaw] == 0.0);
  BOOST_TEST(limits.motion_upper()[kYaw] == robot.velocity_limit()[kYaw]);
  BOOST_TEST(limits.motion_lower()[kYaw] == -robot.velocity_limit()[kYaw]);
  BOOST_TEST(limits.beyond() == -1);
}

BOOST_AUTO_TEST_CASE(one_sided_limits_work) {
  Vector low = robot.position_lower();
  low[kJoint] = -INFINITY;
  robot.set_position_limits(low, robot.position_upper());
  JointLimits one_sided(robot, options);
  Vector q = Vector::Zero(8);
  q[kJoint] = upper;
  one_sided.update(q);
  BOOST_TEST(one_sided.limited(kJoint));
  BOOST_TEST(one_sided.activation()[kJoint] == 1.0);
  q[kJoint] = -30.0;
  one_sided.update(q);
  BOOST_TEST(one_sided.activation()[kJoint] == 0.0);
  BOOST_TEST(one_sided.motion_lower()[kJoint] == -v_max);
}

BOOST_AUTO_TEST_CASE(the_joint_furthest_beyond_is_named) {
  Vector q = Vector::Zero(8);
  q[3] = robot.position_upper()[3] + 0.01;
  q[7] = robot.position_lower()[7] - 0.02;
  limits.update(q);
  BOOST_TEST(limits.beyond() == 7);
}

BOOST_AUTO_TEST_CASE(buffers_of_single_joints_apply) {
  BOOST_TEST(limits.buffer(3) == 0.2);
  BOOST_TEST(limits.buffer(kJoint) == 0.1);
  Vector q = Vector::Zero(8);
  q[3] = robot.position_upper()[3] - 0.1;
  limits.update(q);
  BOOST_TEST(near(limits.activation()[3], 0.5));
}

BOOST_AUTO_TEST_CASE(engagement_is_one_on_the_bound_and_fades_with_slack) {
  Vector up(8);
  Vector down(8);
  move(upper - 0.05);
  Vector v = Vector::Zero(8);
  v[kJoint] = limits.motion_upper()[kJoint];
  limits.engagement(v, up, down);
  BOOST_TEST(near(up[kJoint], 1.0));
  BOOST_TEST(down[kJoint] == 0.0);
  v[kJoint] -= 0.5 * 8.0 * 0.1;
  limits.engagement(v, up, down);
  BOOST_TEST(near(up[kJoint], 0.5));
  v[kJoint] = -v_max;
  limits.engagement(v, up, down);
  BOOST_TEST(up[kJoint] == 0.0);
  // a bound that the speed limit alone sets is no position limit's
  move(0.0);
  v[kJoint] = v_max;
  limits.engagement(v, up, down);
  BOOST_TEST(up[kJoint] == 0.0);
  v[kYaw] = robot.velocity_limit()[kYaw];
  limits.engagement(v, up, down);
  BOOST_TEST(up[kYaw] == 0.0);
}

BOOST_AUTO_TEST_CASE(blended_bounds_shrink_towards_the_near_limit) {
  Vector low(8);
  Vector high(8);
  move(upper - 0.05);
  limits.blended_speed_bounds(limits.activation(), low, high);
  BOOST_TEST(near(high[kJoint], 0.5 * v_max + 0.5 * limits.target()[kJoint]));
  BOOST_TEST(low[kJoint] == -v_max);
  BOOST_TEST(high[0] == robot.velocity_limit()[0]);
  move(lower);
  limits.blended_speed_bounds(limits.activation(), low, high);
  BOOST_TEST(near(low[kJoint], limits.target()[kJoint]));
  BOOST_TEST(high[kJoint] == v_max);
  limits.blended_speed_bounds(Vector::Zero(8), low, high);
  BOOST_TEST(low[kJoint] == -v_max);
}

BOOST_AUTO_TEST_CASE(blended_bounds_of_unbounded_speeds_are_infinite) {
  robot.set_velocity_limit(Vector::Constant(8, INFINITY));
  JointLimits unbounded(robot, options);
  Vector q = Vector::Zero(8);
  q[kJoint] = upper - 0.05;
  q[7] = robot.position_upper()[7];
  unbounded.update(q);
  Vector low(8);
  Vector high(8);
  unbounded.blended_speed_bounds(unbounded.activation(), low, high);
  BOOST_TEST(high[kYaw] == INFINITY);
  BOOST_TEST(low[kYaw] == -INFINITY);
  BOOST_TEST(high[kJoint] == INFINITY);
  BOOST_TEST(high[7] == unbounded.target()[7]);
}

BOOST_AUTO_TEST_CASE(activation_by_side_is_on_the_near_side) {
  Vector up(8);
  Vector down(8);
  move(upper - 0.05);
  limits.activation_by_side(up, down);
  BOOST_TEST(near(up[kJoint], 0.5));
  BOOST_TEST(down[kJoint] == 0.0);
  move(lower + 0.05);
  limits.activation_by_side(up, down);
  BOOST_TEST(up[kJoint] == 0.0);
  BOOST_TEST(near(down[kJoint], 0.5));
}

BOOST_AUTO_TEST_CASE(rows_and_bounds_are_continuous_in_position) {
  const double step = 1e-7;
  for (double q = lower - 0.3; q < upper + 0.3; q += 1e-3) {
    move(q);
    const Vector before = (Vector(3) << limits.activation()[kJoint], limits.motion_lower()[kJoint],
                           limits.motion_upper()[kJoint])
                              .finished();
    move(q + step);
    const Vector after = (Vector(3) << limits.activation()[kJoint], limits.motion_lower()[kJoint],
                          limits.motion_upper()[kJoint])
                             .finished();
    BOOST_TEST((after - before).lpNorm<Eigen::Infinity>() <= 20.0 * step);
  }
}

BOOST_AUTO_TEST_CASE(bad_options_are_refused) {
  const auto refuse = [&](JointLimitOptions bad, std::initializer_list<std::string> parts) {
    check_error([&] { const JointLimits built(robot, bad); }, parts);
  };
  refuse({.buffer = -0.1}, {"limits: buffer", "positive", "-0.1"});
  refuse({.gain = -2.0}, {"limits: gain", "positive", "-2"});
  refuse({.gain = NAN}, {"limits: gain", "finite"});
  refuse({.margin = 0.0}, {"limits: margin", "positive"});
  refuse({.buffers = {{"arm_joint_2", 0.0}}}, {"buffer of arm_joint_2", "positive"});
  refuse({.buffers = {{"arm_joint_8", 0.1}}}, {"unknown joint 'arm_joint_8'", "did you mean"});
  refuse({.buffers = {{"arm_joint_2", 1.4}}},
         {"buffers of arm_joint_2 overlap", "2.67", "2.8", "below 1.33"});
  refuse({.buffer = 1.4}, {"overlap"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
