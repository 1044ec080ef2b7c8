// LiveGoal: against the closed form of a critically damped spring, and its own differences. Not here: the live page that
// drags it (closed_loop_test).
#include <tope/task/live_goal.hpp>
#include <tope/task/rotation_error.hpp>

#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(live_goal)

BOOST_AUTO_TEST_CASE(moves_like_a_critically_damped_spring) {
  constexpr double dt = 1e-5;
  constexpr double rate = 8.0;
  const Vector3 from{1.0, 0.0, -1.0};
  const Vector3 to{1.5, 0.2, -1.0};
  LiveGoal goal(from, Matrix3::Identity());
  goal.put(to, Matrix3::Identity());
  for (int i = 1; i <= 50000; ++i) {
    goal.advance(dt);
    if (i % 10000 == 0) {
      const double t = i * dt;
      const Vector3 expected = to + (1.0 + rate * t) * std::exp(-rate * t) * (from - to);
      BOOST_TEST((goal.point().position - expected).norm() <= 1e-4);
    }
  }
}

BOOST_AUTO_TEST_CASE(turns_the_short_way_and_stays_a_rotation) {
  constexpr double dt = 1e-3;
  const Matrix3 to = Eigen::AngleAxisd(2.5, Vector3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  LiveGoal goal(Vector3::Zero(), Matrix3::Identity());
  goal.put(Vector3::Zero(), to);
  double before = 2.5;
  for (int i = 0; i < 3000; ++i) {
    const Matrix3 last = goal.rotation().rotation;
    goal.advance(dt);
    const RotationTarget& now = goal.rotation();
    const Vector3 turned = rotation_vector(now.rotation * last.transpose());
    BOOST_TEST((turned / dt - now.angular_velocity).norm() <= 1e-6);
    const double left = rotation_vector(to * now.rotation.transpose()).norm();
    BOOST_TEST(left <= before + 1e-12);
    before = left;
  }
  BOOST_TEST(before <= 1e-6);
  BOOST_TEST((goal.rotation().rotation * goal.rotation().rotation.transpose() - Matrix3::Identity()).norm() <=
             1e-12);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
