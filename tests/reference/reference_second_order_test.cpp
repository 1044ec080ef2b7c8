// References of second order: solved by integration they follow their closed forms, from any start, and arrive.
// Not here: the first order (reference_test).
#include "support/random.hpp"

#include <tope/reference/exponential.hpp>
#include <tope/reference/predefined_time.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(reference_second_order)
namespace {

/// Integrates e'' = reference by RK4 from 0 to `duration`; returns error and rate at the end.
template <typename Reference>
std::pair<Vector, Vector> integrate(const Reference& reference, Vector e, Vector rate, double duration,
                                    int steps) {
  const double h = duration / steps;
  const auto acceleration = [&](double t, const Vector& x, const Vector& v) {
    Vector a(x.size());
    reference.acceleration(t, x, v, a);
    return a;
  };
  for (int i = 0; i < steps; ++i) {
    const double t = i * h;
    const Vector a1 = acceleration(t, e, rate);
    const Vector a2 = acceleration(t + 0.5 * h, e + 0.5 * h * rate, rate + 0.5 * h * a1);
    const Vector v2 = rate + 0.5 * h * a1;
    const Vector a3 = acceleration(t + 0.5 * h, e + 0.5 * h * v2, rate + 0.5 * h * a2);
    const Vector v3 = rate + 0.5 * h * a2;
    const Vector a4 = acceleration(t + h, e + h * v3, rate + h * a3);
    const Vector v4 = rate + h * a3;
    e += h / 6.0 * (rate + 2.0 * v2 + 2.0 * v3 + v4);
    rate += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  return {e, rate};
}

}  // namespace

BOOST_AUTO_TEST_CASE(exponential_has_a_double_pole) {
  Random random(1);
  const Vector e = random.vector(3);
  const Vector rate = random.vector(3);
  const double gain = 2.5;
  const double t = 1.2;
  const auto [end, end_rate] = integrate(Exponential(gain), e, rate, t, 400);
  const Vector expected = std::exp(-gain * t) * (e + t * (rate + gain * e));
  BOOST_TEST((end - expected).norm() <= 1e-9);
}

BOOST_AUTO_TEST_CASE(predefined_time_matches_its_start_and_arrives_at_rest) {
  Random random(2);
  for (int i = 0; i < 10; ++i) {
    const Vector e = random.vector(3);
    const Vector rate = random.vector(3);
    const Vector acceleration = random.vector(3);
    PredefinedTime reference({.duration = 1.5, .gain = 3.0});
    reference.resize(3);
    reference.start(0.0, e, rate, acceleration);
    Vector first(3);
    reference.acceleration(0.0, e, rate, first);
    BOOST_TEST((first - acceleration).norm() <= 1e-12);
    const auto [end, end_rate] = integrate(reference, e, rate, 1.5, 400);
    BOOST_TEST(end.norm() <= 1e-8);
    BOOST_TEST(end_rate.norm() <= 1e-8);
    Vector last(3);
    reference.acceleration(1.5, Vector::Zero(3), Vector::Zero(3), last);
    BOOST_TEST(last.norm() <= 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(new_plan_continues_and_arrives_in_the_time_that_is_left) {
  Random random(3);
  const Vector e = random.vector(3);
  PredefinedTime reference({.duration = 2.0, .gain = 3.0, .replan_over = 0.5});
  reference.resize(3);
  reference.start(0.0, e, Vector::Zero(3), Vector::Zero(3));
  for (const auto& [now, arrival] : {std::pair{0.8, 2.0}, {1.9, 2.4}, {3.0, 3.5}}) {
    const Vector error = random.vector(3);  // where the task was held
    const Vector rate = random.vector(3);
    Vector before(3);
    Vector after(3);
    reference.acceleration(now, error, rate, before);
    PredefinedTime planned = reference;
    planned.replan(now, error, rate, before);
    planned.acceleration(now, error, rate, after);
    BOOST_TEST((after - before).norm() <= 1e-12);
    Vector position = error;
    Vector speed = rate;
    const int steps = 4000;
    const double h = (arrival - now) / steps;
    for (int i = 0; i < steps; ++i) {  // midpoint rule
      Vector a(3);
      planned.acceleration(now + i * h, position, speed, a);
      const Vector half_speed = speed + 0.5 * h * a;
      planned.acceleration(now + (i + 0.5) * h, position + 0.5 * h * speed, half_speed, a);
      position += h * half_speed;
      speed += h * a;
    }
    BOOST_TEST(position.norm() <= 1e-5);
    BOOST_TEST(speed.norm() <= 1e-4);
  }
}

BOOST_AUTO_TEST_CASE(predefined_time_gives_no_step_from_rest) {
  PredefinedTime reference(2.0);
  reference.resize(1);
  const Vector e = Vector::Constant(1, 1.0);
  reference.start(3.0, e, Vector::Zero(1), Vector::Zero(1));
  Vector a(1);
  reference.acceleration(3.0, e, Vector::Zero(1), a);
  BOOST_TEST(a[0] == 0.0);
  reference.acceleration(3.001, e, Vector::Zero(1), a);
  BOOST_TEST(std::abs(a[0]) <= 0.02);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
