// Kinematic: follows velocity commands exactly. Not here: the loop around it (scenario room).
#include "support/robots.hpp"

#include <tope/plant/kinematic.hpp>

#include <boost/test/unit_test.hpp>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(kinematic)

BOOST_AUTO_TEST_CASE(moves_by_command_times_period) {
  Random random(1);
  const Vector start = random.vector(8);
  const Vector u = random.vector(8);
  Kinematic plant(youbot());
  BOOST_TEST(plant.position().norm() == 0.0);
  plant.reset(start);
  BOOST_TEST((plant.position() - start).norm() == 0.0);
  BOOST_TEST(plant.velocity().norm() == 0.0);
  plant.step(u, 0.1);
  plant.step(-0.5 * u, 0.1);
  BOOST_TEST((plant.position() - start - 0.05 * u).norm() <= 1e-15);
  BOOST_TEST((plant.velocity() + 0.5 * u).norm() == 0.0);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
