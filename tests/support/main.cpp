#define BOOST_TEST_MODULE tope
#include <boost/test/unit_test.hpp>
