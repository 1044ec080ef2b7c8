// References against the analytic solution of the error they promise, continuity at both ends, and bad
// gains. Moving targets: velocities against finite differences. Not here: the tasks that use them (task
// room).
#include "support/random.hpp"
#include "support/text.hpp"

#include <tope/reference/reference.hpp>
#include <tope/reference/target.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(reference)
namespace {

constexpr double kStart = 1.5;     // s
constexpr double kDuration = 4.0;  // s
constexpr double kGain = 2.5;      // 1/s

PredefinedTime started(const Vector& initial) {
  PredefinedTime reference({.duration = kDuration, .gain = kGain});
  reference.resize(static_cast<int>(initial.size()));
  const Vector at_rest = Vector::Zero(initial.size());
  reference.start(kStart, initial, at_rest, at_rest);
  return reference;
}

Vector rate_of(const auto& reference, double t, const Vector& error) {
  Vector rate = Vector::Zero(error.size());
  reference.rate(t, error, rate);
  return rate;
}

double time_base(double t) {
  const double s = std::clamp((t - kStart) / kDuration, 0.0, 1.0);
  return 1.0 - 3.0 * s * s + 2.0 * s * s * s;
}

Matrix3 skew(const Vector3& w) {
  Matrix3 result;
  result << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return result;
}

}  // namespace

BOOST_AUTO_TEST_CASE(new_plan_continues_and_arrives_in_the_time_that_is_left) {
  Random random(4);
  PredefinedTime reference({.duration = kDuration, .gain = kGain, .replan_over = 1.0});
  reference.resize(2);
  reference.start(kStart, random.vector(2), Vector::Zero(2), Vector::Zero(2));
  for (const auto& [now, arrival] : {std::pair{3.0, kStart + kDuration}, {5.2, 6.2}, {9.0, 10.0}}) {
    Vector error = random.vector(2);  // where the task was held
    const Vector before = rate_of(reference, now, error);
    PredefinedTime planned = reference;
    planned.replan(now, error, before, Vector::Zero(2));
    BOOST_TEST((rate_of(planned, now, error) - before).norm() <= 1e-12);
    const int steps = 4000;
    const double h = (arrival - now) / steps;
    for (int i = 0; i < steps; ++i) {  // midpoint rule
      const Vector half = error + 0.5 * h * rate_of(planned, now + i * h, error);
      error += h * rate_of(planned, now + (i + 0.5) * h, half);
    }
    BOOST_TEST(error.norm() <= 1e-5);
    BOOST_TEST(rate_of(planned, arrival, Vector::Zero(2)).norm() <= 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(exponential_is_the_rate_of_its_solution) {
  Random random(1);
  const Vector initial = random.vector(3);
  const auto solution = [&](double t) { return Vector(std::exp(-kGain * t) * initial); };
  const Exponential exponential(kGain);
  const double h = 1e-6;
  for (const double t : {0.0, 0.3, 2.0}) {
    const Vector slope = (solution(t + h) - solution(t - h)) / (2.0 * h);
    BOOST_TEST((rate_of(exponential, t, solution(t)) - slope).norm() <= 1e-8);
  }
  BOOST_TEST(!exponential.duration().has_value());
}

BOOST_AUTO_TEST_CASE(predefined_time_is_the_rate_of_its_solution) {
  Random random(2);
  const Vector initial = random.vector(3);
  const Vector deviation = random.vector(3, 0.1);
  const PredefinedTime reference = started(initial);
  // e = h(s) e0, and a deviation from it that decays with the gain
  const auto solution = [&](double t) {
    return Vector(time_base(t) * initial + std::exp(-kGain * (t - kStart)) * deviation);
  };
  const double h = 1e-6;
  for (const double share : {0.1, 0.5, 0.9, 1.2}) {
    const double t = kStart + share * kDuration;
    const Vector slope = (solution(t + h) - solution(t - h)) / (2.0 * h);
    BOOST_TEST((rate_of(reference, t, solution(t)) - slope).norm() <= 1e-8);
  }
  BOOST_TEST(*reference.duration() == kDuration);
}

BOOST_AUTO_TEST_CASE(predefined_time_starts_from_rest_and_arrives) {
  Random random(3);
  const Vector initial = random.vector(4);
  const PredefinedTime reference = started(initial);
  BOOST_TEST(rate_of(reference, kStart, initial).norm() <= 1e-15);
  BOOST_TEST(rate_of(reference, kStart + kDuration, Vector::Zero(4)).norm() <= 1e-15);
  Vector error = initial;  // integrated as a loop would
  const double dt = 1e-4;
  for (int i = 0; i < std::lround(kDuration / dt); ++i) {
    error += dt * rate_of(reference, kStart + i * dt, error);
  }
  BOOST_TEST(error.norm() <= 1e-4);
}

BOOST_AUTO_TEST_CASE(predefined_time_is_continuous_at_both_ends) {
  Random random(4);
  const Vector initial = random.vector(3);
  const Vector error = random.vector(3);
  const PredefinedTime reference = started(initial);
  for (const double t : {kStart, kStart + kDuration}) {
    for (const double step : {1e-4, 1e-6}) {
      const Vector change = rate_of(reference, t + step, error) - rate_of(reference, t - step, error);
      BOOST_TEST(change.norm() <= 10.0 * step * initial.norm());
    }
  }
  const Vector after = rate_of(reference, kStart + 2.0 * kDuration, error);
  BOOST_TEST((after + kGain * error).norm() <= 1e-14);
}

BOOST_AUTO_TEST_CASE(bad_gains_are_refused) {
  check_error([] { Exponential(-1.0); }, {"Exponential", "gain", "positive", "-1"});
  check_error([] { Exponential(0.0); }, {"gain", "positive"});
  check_error([] { Exponential(NAN); }, {"gain", "finite", "nan"});
  check_error([] { PredefinedTime({.duration = 1.0, .gain = -2.0}); }, {"PredefinedTime", "gain", "-2"});
  check_error([] { PredefinedTime({.duration = 0.0, .gain = 2.0}); }, {"duration", "positive"});
  check_error([] { PredefinedTime({.duration = INFINITY, .gain = 2.0}); }, {"duration", "finite"});
}

BOOST_AUTO_TEST_CASE(moving_points_give_their_velocity) {
  Random random(5);
  const Vector3 from = random.vector(3);
  const Vector3 by = random.vector(3);
  const double h = 1e-5;
  for (const Target<PointTarget>& target : {moving_along_line(from, by), moving_along_sine(from, by, 0.7)}) {
    BOOST_TEST((target.at(0.0).position - from).norm() <= 1e-15);
    for (const double t : {0.0, 0.4, 3.0}) {
      const Vector3 slope = (target.at(t + h).position - target.at(t - h).position) / (2.0 * h);
      BOOST_TEST((target.at(t).velocity - slope).norm() <= 1e-8);
    }
  }
}

BOOST_AUTO_TEST_CASE(spinning_frames_give_their_angular_velocity) {
  Random random(6);
  const Matrix3 start = random.rotation();
  const Vector3 angular_velocity = random.vector(3);
  const Target<RotationTarget> target = spinning(start, angular_velocity);
  BOOST_TEST((target.at(0.0).rotation - start).norm() <= 1e-15);
  const double h = 1e-5;
  for (const double t : {0.0, 0.4, 3.0}) {
    const RotationTarget now = target.at(t);
    const Matrix3 slope = (target.at(t + h).rotation - target.at(t - h).rotation) / (2.0 * h);
    BOOST_TEST((skew(now.angular_velocity) * now.rotation - slope).norm() <= 1e-8);
    BOOST_TEST((now.angular_velocity - angular_velocity).norm() <= 1e-14);
  }
  BOOST_TEST((spinning(start, Vector3::Zero()).at(2.0).rotation - start).norm() <= 1e-15);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
