// Smoothness against signals whose variation and acceleration are known.
#include <tope/scenario/smoothness.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <numbers>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(smoothness)

BOOST_AUTO_TEST_CASE(measures_an_oscillation_over_the_last_half) {
  const double dt = 1e-3;
  const int cycles = 4000;
  const double rate = 2.0 * std::numbers::pi;  // one turn a second
  Smoothness measured(2, 1, cycles, dt);
  for (int i = 0; i <= cycles; ++i) {
    const double t = i * dt;
    const double loud = i < cycles / 2 - 2 ? 100.0 : 1.0;  // the first half does not count
    const Vector v{{loud * std::sin(rate * t), 0.3}};
    const Vector error{{0.1 * loud * std::sin(rate * t), 0.1 * loud * std::cos(rate * t), 0.2}};
    measured.observe(v, {error});
  }
  BOOST_TEST(std::abs(measured.velocity_variation()[0] - 8.0) <= 1e-2);  // two turns, four amplitudes each
  BOOST_TEST(measured.velocity_variation()[1] == 0.0);
  BOOST_TEST(std::abs(measured.acceleration(0) - 0.1 * rate * rate) <= 1e-3 * rate * rate);
}

BOOST_AUTO_TEST_CASE(a_run_of_one_cycle_has_none) {
  Smoothness measured(1, 1, 1, 0.1);
  measured.observe(Vector::Constant(1, 1.0), {Vector::Constant(1, 1.0)});
  measured.observe(Vector::Constant(1, 2.0), {Vector::Constant(1, 3.0)});
  BOOST_TEST(measured.acceleration(0) == 0.0);
  BOOST_TEST(measured.velocity_variation()[0] == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
