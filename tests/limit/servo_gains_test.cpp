// The paper's servo gains as poles. Not here: the rows that use them (joint_limits_second_order_test).
#include "support/text.hpp"

#include <tope/limit/servo_gains.hpp>

#include <boost/test/unit_test.hpp>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(servo_gains)

BOOST_AUTO_TEST_CASE(poles_have_the_pairs_sum_and_product) {
  for (const auto& [p, v] : {std::pair{80.0, 24.0}, {9.0, 6.0}, {1e-6, 10.0}}) {
    const ServoGains gains = ServoGains::from_paper(p, v);
    BOOST_TEST(gains.gain * gains.servo_gain == p, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(gains.gain + gains.servo_gain == v, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(gains.gain <= gains.servo_gain);
  }
}

BOOST_AUTO_TEST_CASE(underdamped_pairs_are_refused) {
  check_error([] { ServoGains::from_paper(100.0, 10.0); },
              {"lambda_v^2 < 4 lambda_p", "100.0", "400.0", "raise lambda_v to at least 20",
               "lambda_p to at most 25"});
  check_error([] { ServoGains::from_paper(-1.0, 10.0); }, {"lambda_p", "positive", "-1"});
  check_error([] { ServoGains::from_paper(1.0, 0.0); }, {"lambda_v", "positive", "0.0"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
