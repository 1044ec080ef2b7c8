// Limit rows of torque mode: their formulas, and invariance of a sampled double integrator under the hardest push that
// the conditions admit, at the bound of the period and beyond it. Not here: velocity mode (joint_limits_test).
#include "support/robots.hpp"

#include <tope/limit/conditions.hpp>
#include <tope/limit/joint_limits.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(joint_limits_second_order)
namespace {

constexpr int kJoint = 7;  // arm_joint_5
constexpr double kGain = 4.0;
constexpr double kServo = 20.0;
constexpr double kBuffer = 0.1;
const Vector kStrong = Vector::Constant(8, 1e3);  // drives that can brake anything

JointLimitOptions options(Measure measure = Measure::predicted) {
  return {.buffer = kBuffer, .gain = kGain, .servo_gain = kServo, .measure = measure};
}

/// The joint at `distance` before its upper limit with speed v, all others at rest.
void place(JointLimits& limits, const Robot& robot, double distance, double v) {
  Vector q = Vector::Zero(8);
  Vector speed = Vector::Zero(8);
  q[kJoint] = robot.position_upper()[kJoint] - distance;
  speed[kJoint] = v;
  limits.update_second_order(q, speed);
}

/// Largest position beyond the upper limit of a joint that is pushed with the largest acceleration that the row's
/// activation leaves, from many starts inside the safe set, sampled with period dt.
double worst_crossing(const Robot& robot, double dt, double buffer) {
  JointLimits limits(robot, {.buffer = buffer, .gain = kGain, .servo_gain = kServo});
  Vector lower(8);
  Vector upper(8);
  double worst = -1.0;
  for (double start = 0.005; start < 3.0 * buffer; start += 0.11 * buffer) {
    double distance = start;
    double v = 0.0;
    for (int i = 0; i < static_cast<int>(2.0 / dt); ++i) {
      place(limits, robot, distance, v);
      limits.blended_acceleration_bounds(limits.activation(), dt, lower, upper);
      const double a = upper[kJoint];
      distance -= dt * v + 0.5 * dt * dt * a;
      v = std::min(v + dt * a, robot.velocity_limit()[kJoint]);
      worst = std::max(worst, -distance);
    }
  }
  return worst;
}

}  // namespace

BOOST_AUTO_TEST_CASE(row_is_the_papers_on_the_predicted_position) {
  const Robot robot = youbot();
  JointLimits limits(robot, options());
  // far enough below the speed bound that the envelope is its straight part to within the corner's rounding
  for (const double distance : {0.02, 0.05, 0.1}) {
    for (const double v : {-0.2, 0.0, 0.1}) {
      place(limits, robot, distance, v);
      const double predicted = distance - v / kGain;
      BOOST_TEST(std::abs(limits.activation()[kJoint] -
                          ramp(Ramp::raised_cosine, 1.0 - predicted / kBuffer)) < 0.06);
      const double servo = -kGain * kServo * (kBuffer - distance) - (kGain + kServo) * v;
      BOOST_TEST(std::abs(limits.target()[kJoint] - servo) < 0.15);
    }
  }
}

BOOST_AUTO_TEST_CASE(measure_position_is_the_paper_to_the_letter) {
  const Robot robot = youbot();
  JointLimits limits(robot, options(Measure::position));
  place(limits, robot, 0.03, 0.5);
  BOOST_TEST(std::abs(limits.activation()[kJoint] - ramp(Ramp::raised_cosine, 0.7)) <= 1e-12);
  BOOST_TEST(std::abs(limits.target()[kJoint] - (-kGain * kServo * 0.07 - (kGain + kServo) * 0.5)) <= 1e-12);
}

BOOST_AUTO_TEST_CASE(envelope_is_below_both_lines_and_meets_them) {
  const Robot robot = youbot();
  const double v_max = robot.velocity_limit()[kJoint];
  for (const double gain : {0.1, 1.0, 10.0}) {
    JointLimitOptions slow = options();
    slow.gain = gain;
    const JointLimits limits(robot, slow);
    BOOST_TEST(std::abs(limits.allowed_speed(kJoint, 0.0)) <= 1e-15);
    BOOST_TEST(std::abs(limits.allowed_speed(kJoint, 1e6) - v_max) <= 1e-6);
    for (double distance = 1e-3; distance < 100.0; distance *= 1.1) {
      BOOST_TEST(limits.allowed_speed(kJoint, distance) < gain * distance);
      BOOST_TEST(limits.allowed_speed(kJoint, distance) < v_max);
      BOOST_TEST(limits.allowed_speed(kJoint, distance) > 0.9 * std::min(gain * distance, v_max));
    }
  }
}

BOOST_AUTO_TEST_CASE(bounds_hold_the_envelope_as_a_servo_would) {
  const Robot robot = youbot();
  JointLimits limits(robot, options());
  // integrate dv/dt = bound: the speed joins the envelope and the joint comes to rest at the margin
  double distance = 0.8;
  double v = 0.0;
  const double dt = 1e-4;
  for (int i = 0; i < 50000; ++i) {
    place(limits, robot, distance, v);
    const double a = limits.motion_upper()[kJoint];
    distance -= dt * v + 0.5 * dt * dt * a;
    v += dt * a;
    BOOST_TEST_REQUIRE(distance > 0.0);
    BOOST_TEST_REQUIRE(v <= robot.velocity_limit()[kJoint]);
  }
  BOOST_TEST(distance >= limits.options().margin);
  BOOST_TEST(distance < limits.options().margin + 5e-3);
  BOOST_TEST(std::abs(v) < 1e-3);
}

BOOST_AUTO_TEST_CASE(headroom_grows_with_the_bound_at_rest) {
  const Robot robot = youbot();
  const Vector at_limit = Vector::Constant(8, 0.1);
  const Vector away = Vector::Constant(8, 1.0);
  Vector lower(8);
  Vector upper(8);
  double last = 0.0;
  for (const double beyond_margin : {-0.1, 0.0, 1e-3, 0.01, 0.1, 1.0}) {
    for (const double v : {-0.5, 0.0, 0.5}) {  // none of the speed's business
      JointLimits limits(robot, options());
      place(limits, robot, limits.options().margin + beyond_margin, v);
      limits.headroom(at_limit, away, lower, upper);
      const double bound = kServo * std::max(0.0, limits.allowed_speed(kJoint, beyond_margin));
      BOOST_TEST(upper[kJoint] == 0.1 + 0.9 * bound / (bound + 1.8), boost::test_tools::tolerance(1e-12));
    }
    BOOST_TEST(upper[kJoint] >= last);
    last = upper[kJoint];
  }
  JointLimits limits(robot, options());
  place(limits, robot, 0.5, 0.0);
  limits.headroom(at_limit, at_limit, lower, upper);
  BOOST_TEST(upper[kJoint] == 0.1);
}

// docs/theory.md, 5.6: a period cuts the envelope's curve, by so much at most.
BOOST_AUTO_TEST_CASE(speed_exceeds_the_envelope_by_its_share_at_most) {
  const Robot robot = youbot();
  const double servo = 10.0;
  const double share = 0.1;
  const double dt =
      share * (servo - (1.0 + share) * kGain) / (2.51 * std::pow(1.0 + share, 3) * kGain * kGain);
  JointLimits limits(robot, {.gain = kGain, .servo_gain = servo});
  const double margin = limits.options().margin;
  Random random(1);
  int above = 0;
  for (int i = 0; i < 20000; ++i) {
    const double distance = margin + std::pow(10.0, random.uniform(-6.0, 0.5));
    const double most = (1.0 + share) * limits.allowed_speed(kJoint, distance - margin);
    const double v = random.chance(0.5) ? most : random.uniform(-1.0, most);
    place(limits, robot, distance, v);
    const double a = limits.motion_upper()[kJoint];
    const double next = distance - dt * v - 0.5 * dt * dt * a;
    const double allowed = limits.allowed_speed(kJoint, next - margin);
    BOOST_TEST_REQUIRE(next >= margin, distance << " " << v);
    BOOST_TEST_REQUIRE(v + dt * a <= (1.0 + share) * allowed + 1e-12, distance << " " << v);
    above += v < most && v + dt * a > allowed ? 1 : 0;
  }
  BOOST_TEST(above > 0);  // without a share the set would be left
}

BOOST_AUTO_TEST_CASE(bounds_leave_an_interval_everywhere) {
  const Robot robot = youbot();
  JointLimits limits(robot, options());
  for (double distance = -0.5; distance < 5.7; distance += 0.01) {
    for (double v = -1.57; v <= 1.57; v += 0.157) {
      place(limits, robot, distance, v);
      BOOST_TEST_REQUIRE(limits.motion_upper()[kJoint] - limits.motion_lower()[kJoint] > 5.0);
    }
  }
}

BOOST_AUTO_TEST_CASE(sides_mirror_each_other) {
  const Robot robot = youbot();
  JointLimits limits(robot, options());
  Vector q = Vector::Zero(8);
  Vector v = Vector::Zero(8);
  q[kJoint] = robot.position_upper()[kJoint] - 0.04;
  v[kJoint] = 0.1;
  limits.update_second_order(q, v);
  const double target = limits.target()[kJoint];
  const double bound = limits.motion_upper()[kJoint];
  limits.update_second_order(-q, -v);  // limits of this joint are symmetric
  BOOST_TEST(std::abs(limits.target()[kJoint] + target) <= 1e-12);
  BOOST_TEST(std::abs(limits.motion_lower()[kJoint] + bound) <= 1e-12);
}

/// Longest period that condition (C) of docs/theory.md admits for a push with `acceleration`.
double threshold(const Robot& robot, Ramp shape, double acceleration) {
  const double v_max = robot.velocity_limit()[kJoint];
  double low = 0.0;
  double high = 1.0 / kGain;
  for (int i = 0; i < 60; ++i) {
    const double dt = 0.5 * (low + high);
    const double c = 1.0 + 0.5 * kGain * dt;
    const double travel = ramp_slope_factor(shape) * dt * (v_max + c * acceleration / kGain);
    (travel <= kBuffer * (1.0 - 0.5 * kGain * kGain * dt * dt) ? low : high) = dt;
  }
  return low;
}

struct Excess {
  double position = -1.0;   // furthest beyond the limit, between the samples too
  double predicted = -1.0;  // the same of the position that the joint is braking to
};

/// Pushes the joint with (1 - xi) acceleration + xi target from every state of a grid over the safe set.
Excess push_from_everywhere(const Robot& robot, Ramp shape, double acceleration, double dt) {
  JointLimits limits(robot, {.buffer = kBuffer, .gain = kGain, .ramp = shape, .servo_gain = kServo});
  const double v_max = robot.velocity_limit()[kJoint];
  Excess worst;
  for (double start = 0.0; start <= 0.7; start += 0.002) {
    for (double speed = -v_max; speed <= std::min(v_max, kGain * start); speed += 0.01) {
      double distance = start;
      double v = speed;
      for (int i = 0; i < 20; ++i) {
        place(limits, robot, distance, v);
        const double xi = limits.activation()[kJoint];
        const double a = (1.0 - xi) * acceleration + xi * limits.target()[kJoint];
        const double peak = a < 0.0 && v > 0.0 ? std::min(dt, -v / a) : dt;
        worst.position = std::max(worst.position, peak * v + 0.5 * peak * peak * a - distance);
        distance -= dt * v + 0.5 * dt * dt * a;
        v = std::min(v + dt * a, v_max);
        worst.predicted = std::max(worst.predicted, v / kGain - distance);
      }
    }
  }
  return worst;
}

BOOST_AUTO_TEST_CASE(safe_set_is_invariant_up_to_the_threshold_and_left_at_twice_it) {
  const Robot robot = youbot();
  for (const Ramp shape : {Ramp::raised_cosine, Ramp::quintic}) {
    const double acceleration = 200.0;
    const double dt = threshold(robot, shape, acceleration);
    const Excess at = push_from_everywhere(robot, shape, acceleration, dt);
    BOOST_TEST(at.position <= 1e-12);
    BOOST_TEST(at.predicted <= 1e-12);
    const Excess beyond = push_from_everywhere(robot, shape, acceleration, 2.0 * dt);
    BOOST_TEST(beyond.position > 1e-4);
    BOOST_TEST(beyond.predicted > 1e-2);
  }
}

BOOST_AUTO_TEST_CASE(blended_rows_keep_the_limit_at_the_conditions_edge) {
  const Robot robot = youbot();
  for (const double dt : {1e-3, 5e-3}) {
    JointLimits limits(robot, {.buffer = 0.3, .gain = kGain, .servo_gain = kServo});
    double buffer = 0.3;
    for (const Condition& condition :
         torque_conditions(robot, limits, LimitMethod::chain, Vector::Constant(8, 0.5), dt, kStrong)) {
      if (condition.joint == "arm_joint_5" && condition.name == "buffer wide enough for the period") {
        BOOST_TEST(condition.holds());
        buffer = 1.02 * condition.value;
      }
    }
    buffer = std::max(buffer, 0.02);
    BOOST_TEST(worst_crossing(robot, dt, buffer) <= 0.0);
  }
}

BOOST_AUTO_TEST_CASE(conditions_name_what_fails) {
  const Robot robot = youbot();
  JointLimits limits(robot, {.buffer = 0.01, .gain = kGain, .servo_gain = kServo});
  bool named = false;
  for (const Condition& condition :
       torque_conditions(robot, limits, LimitMethod::chain, Vector::Constant(8, 0.5), 0.02, kStrong)) {
    named = named || (!condition.holds() && condition.joint == "arm_joint_2" &&
                      condition.advice.find("raise the buffer of arm_joint_2") != std::string::npos);
  }
  BOOST_TEST(named);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
