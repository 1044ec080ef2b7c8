// Limits that move: a joint that always goes as far as it may never crosses one, in both orders and for rows as well as
// for bounds; far from the speed bound all is as in the frame of the limit; bad motions change nothing. Not here: the
// controller's move_limits (controller room), scenarios that use it (scenario room).
#include "support/robots.hpp"

#include <tope/limit/joint_limits.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tope::test {
namespace moving_limits {

constexpr int kJoint = 4;
constexpr double kPeriod = 1e-3;
constexpr double kMargin = 1e-3;

struct Fixture {
  Robot robot = youbot();
  JointLimits limits{robot, {.gain = 10.0, .servo_gain = 20.0, .margin = kMargin}};
  double start = robot.position_upper()[kJoint];
  double lower = robot.position_lower()[kJoint];
  Vector q = Vector::Zero(8);
  Vector v = Vector::Zero(8);

  double upper_at(double t, double rate) const { return start + rate * t; }
  void place_upper(double t, double rate) {
    BOOST_TEST(limits.move(kJoint, {.lower = lower, .upper = upper_at(t, rate), .upper_rate = rate}));
  }
};

}  // namespace moving_limits

BOOST_FIXTURE_TEST_SUITE(moving_limits, Fixture)

BOOST_AUTO_TEST_CASE(the_fastest_allowed_motion_stays_inside) {
  for (const double rate : {-0.5, -0.1, 0.0, 0.1}) {
    q[kJoint] = start - 0.5;
    double nearest = 1.0;
    for (int i = 0; i < 2000; ++i) {
      place_upper(i * kPeriod, rate);
      limits.update(q);
      q[kJoint] += kPeriod * limits.motion_upper()[kJoint];
      nearest = std::min(nearest, upper_at((i + 1) * kPeriod, rate) - q[kJoint]);
    }
    BOOST_TEST(std::abs(nearest - kMargin) <= 1e-6, "rate " << rate << ": nearest " << nearest);
  }
}

BOOST_AUTO_TEST_CASE(the_largest_allowed_acceleration_stays_inside) {
  for (const double rate : {-0.5, -0.1, 0.0, 0.1}) {
    q[kJoint] = start - 0.5;
    v.setZero();
    double nearest = 1.0;
    for (int i = 0; i < 4000; ++i) {
      place_upper(i * kPeriod, rate);
      limits.update_second_order(q, v);
      v[kJoint] += kPeriod * limits.motion_upper()[kJoint];
      q[kJoint] += kPeriod * v[kJoint];
      nearest = std::min(nearest, upper_at((i + 1) * kPeriod, rate) - q[kJoint]);
    }
    BOOST_TEST(nearest > 0.0, "rate " << rate << ": nearest " << nearest);
    BOOST_TEST(nearest < 0.01, "rate " << rate << ": gives away " << nearest);
  }
}

BOOST_AUTO_TEST_CASE(a_row_follows_its_limit) {
  for (const bool second_order : {false, true}) {
    q[kJoint] = start - 0.02;
    v.setZero();
    for (int i = 0; i < 2000; ++i) {
      place_upper(i * kPeriod, -0.1);
      if (second_order) {
        limits.update_second_order(q, v);
        v[kJoint] += kPeriod * limits.target()[kJoint];
      } else {
        limits.update(q);
        v[kJoint] = limits.target()[kJoint];
      }
      q[kJoint] += kPeriod * v[kJoint];
    }
    // at the inner edge of its buffer, with its speed
    BOOST_TEST(std::abs(upper_at(2.0, -0.1) - q[kJoint] - 0.1) < 2e-3);
    BOOST_TEST(std::abs(v[kJoint] + 0.1) < 2e-3);
  }
}

BOOST_AUTO_TEST_CASE(a_lower_limit_mirrors_an_upper_one) {
  const double middle = 0.5 * (start + lower);
  for (const bool second_order : {false, true}) {
    const auto bounds = [&](double sign) {
      q[kJoint] = middle + sign * (start - middle - 0.03);
      v[kJoint] = sign * 0.2;
      LimitMotion motion{.lower = lower, .upper = start};
      (sign > 0.0 ? motion.upper_rate : motion.lower_rate) = -sign * 0.15;
      BOOST_TEST(limits.move(kJoint, motion));
      second_order ? limits.update_second_order(q, v) : limits.update(q);
      return sign > 0.0 ? limits.motion_upper()[kJoint] : -limits.motion_lower()[kJoint];
    };
    BOOST_TEST(std::abs(bounds(1.0) - bounds(-1.0)) <= 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(away_from_the_speed_bound_only_relative_motion_counts) {
  q[kJoint] = start - 0.02;
  for (const double rate : {-0.2, 0.1}) {
    place_upper(0.0, 0.0);
    limits.update(q);
    const double still = limits.motion_upper()[kJoint];
    place_upper(0.0, rate);
    limits.update(q);
    BOOST_TEST(std::abs(limits.motion_upper()[kJoint] - still - rate) <= 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(bad_motions_change_nothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BOOST_TEST(!limits.move(-1, {.lower = lower, .upper = start}));
  BOOST_TEST(!limits.move(8, {.lower = lower, .upper = start}));
  BOOST_TEST(!limits.move(kJoint, {.lower = lower, .upper = nan}));
  BOOST_TEST(!limits.move(kJoint, {.lower = lower, .upper = start, .upper_rate = nan}));
  BOOST_TEST(!limits.move(kJoint, {.lower = lower, .upper = lower + 0.1}));  // buffers would overlap
  BOOST_TEST(limits.upper()[kJoint] == start);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
