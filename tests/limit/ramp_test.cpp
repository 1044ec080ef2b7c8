// Ramps from 0 to 1: their ends, their symmetry, the factor of their slope.
#include <tope/limit/ramp.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(ramps)

BOOST_AUTO_TEST_CASE(rise_from_zero_to_one) {
  for (const Ramp shape : {Ramp::raised_cosine, Ramp::quintic}) {
    BOOST_TEST(ramp(shape, -0.5) == 0.0);
    BOOST_TEST(ramp(shape, 0.0) == 0.0);
    BOOST_TEST(std::abs(ramp(shape, 0.5) - 0.5) <= 1e-12);
    BOOST_TEST(ramp(shape, 1.0) == 1.0);
    BOOST_TEST(ramp(shape, 7.0) == 1.0);
    const double h = 1e-5;
    BOOST_TEST(ramp(shape, h) <= 10.0 * h * h);  // no kink at either end
    BOOST_TEST(1.0 - ramp(shape, 1.0 - h) <= 10.0 * h * h);
    for (double x = 0.0; x < 1.0; x += 0.01) {
      BOOST_TEST(ramp(shape, x + 0.01) >= ramp(shape, x));
      BOOST_TEST(std::abs(ramp(shape, x) + ramp(shape, 1.0 - x) - 1.0) <= 1e-12);
    }
  }
  const double quarter = 0.5 - 0.5 * std::cos(0.25 * std::numbers::pi);  // (24)-(25)
  BOOST_TEST(std::abs(ramp(Ramp::raised_cosine, 0.25) - quarter) <= 1e-12);
}

BOOST_AUTO_TEST_CASE(slope_factor_is_the_supremum_rounded_up) {
  for (const Ramp shape : {Ramp::raised_cosine, Ramp::quintic}) {
    double largest = 0.0;
    for (int i = 1; i <= 1000000; ++i) {
      const double x = i * 1e-6;
      largest = std::max(largest, (1.0 - ramp(shape, 1.0 - x)) / x);
    }
    BOOST_TEST(largest <= ramp_slope_factor(shape));
    BOOST_TEST(ramp_slope_factor(shape) - largest <= 2e-4);
    BOOST_TEST_MESSAGE("slope factor " << largest << ", stated " << ramp_slope_factor(shape));
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
