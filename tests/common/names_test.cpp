// Suggestions for names that are misspelled. Not here: where they appear in messages (robot, task and
// scenario rooms).
#include <tope/common/names.hpp>

#include <boost/test/unit_test.hpp>

#include <string>
#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(names)

BOOST_AUTO_TEST_CASE(the_nearest_name_is_found_when_one_is_near) {
  const std::vector<std::string> known{"buffer", "gain", "margin", "arm_joint_1", "arm_joint_2"};
  BOOST_TEST(nearest_name("bufer", known) == "buffer");
  BOOST_TEST(nearest_name("gains", known) == "gain");
  BOOST_TEST(nearest_name("arm_jiont_2", known) == "arm_joint_2");
  BOOST_TEST(nearest_name("gain", known) == "gain");
  BOOST_TEST(nearest_name("elephant", known).empty());
  BOOST_TEST(nearest_name("", std::vector<std::string>{}).empty());
}

BOOST_AUTO_TEST_CASE(a_hint_lists_what_is_known_when_none_is_near) {
  const std::vector<std::string> known{"buffer", "gain"};
  BOOST_TEST(name_hint("bufer", known) == "; did you mean 'buffer'?");
  BOOST_TEST(name_hint("elephant", known) == "; known: buffer, gain");
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
