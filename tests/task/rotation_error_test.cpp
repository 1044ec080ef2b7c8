// rotation_vector and inverse_right_jacobian at the identity, for tiny, random and nearly half turns. Not
// here: the tasks built on them (task_test).
#include "support/random.hpp"

#include <tope/task/rotation_error.hpp>

#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <cmath>
#include <numbers>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(rotation_error)
namespace {

constexpr double kPi = std::numbers::pi;

Matrix3 turn(double angle, const Vector3& axis) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix(); }

Matrix3 exponential(const Vector3& e) {
  return e.norm() > 0.0 ? turn(e.norm(), Vector3(e.normalized())) : Matrix3::Identity().eval();
}

}  // namespace

BOOST_AUTO_TEST_CASE(inverts_the_exponential) {
  BOOST_TEST(rotation_vector(Matrix3::Identity()).norm() == 0.0);
  for (const double angle : {1e-12, 1e-9, 1e-7, 1e-4, 0.1, 1.0, 2.0, 3.0, kPi - 1e-3, kPi - 1e-6}) {
    for (int seed = 0; seed < 20; ++seed) {
      BOOST_TEST_CONTEXT("angle " << angle << ", seed " << seed) {
        Random random(seed);
        const Vector3 axis = random.unit();
        BOOST_TEST((rotation_vector(turn(angle, axis)) - angle * axis).norm() <=
                   1e-14 + 1e-9 * (angle > 3.0 ? 1.0 : angle));
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(half_turns_have_length_pi) {
  for (int seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const Vector3 axis = random.unit();
    const Vector3 e = rotation_vector(turn(kPi, axis));
    BOOST_TEST(std::abs(e.norm() - kPi) <= 1e-12);
    BOOST_TEST(e.normalized().cross(axis).norm() <= 1e-9);
  }
  for (const Vector3& axis : {Vector3::UnitX().eval(), Vector3::UnitY().eval(), Vector3::UnitZ().eval()}) {
    BOOST_TEST(std::abs(rotation_vector(turn(kPi, axis)).norm() - kPi) <= 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(length_stays_within_pi) {
  for (int seed = 0; seed < 1000; ++seed) {
    Random random(seed);
    const Matrix3 rotation = random.rotation();
    const Vector3 e = rotation_vector(rotation);
    BOOST_TEST(e.norm() <= kPi + 1e-12);
    BOOST_TEST((exponential(e) - rotation).norm() <= 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(says_vector_angle_and_jacobian_at_once) {
  Random random(9);
  for (const double angle : {0.0, 1e-9, 1e-3, 0.0099, 0.0101, 0.5, 2.0, 3.1, kPi}) {
    const Vector3 axis = random.vector(3).normalized();
    const RotationError e = tope::rotation_error(turn(angle, axis));
    BOOST_TEST(std::abs(e.angle - angle) <= 1e-12);
    BOOST_TEST((e.vector - rotation_vector(turn(angle, axis))).norm() == 0.0);
    BOOST_TEST((e.inverse_right_jacobian - inverse_right_jacobian(e.vector)).norm() <= 1e-11);
  }
}

BOOST_AUTO_TEST_CASE(inverse_right_jacobian_is_the_derivative_of_the_logarithm) {
  BOOST_TEST((inverse_right_jacobian(Vector3::Zero()) - Matrix3::Identity()).norm() == 0.0);
  const double h = 1e-5;
  for (const double angle : {0.0, 1e-7, 1e-4, 0.99e-3, 1.01e-3, 0.1, 1.0, 2.0, 3.0, kPi - 0.06}) {
    for (int seed = 0; seed < 20; ++seed) {
      BOOST_TEST_CONTEXT("angle " << angle << ", seed " << seed) {
        Random random(seed);
        const Vector3 e = angle * random.unit();
        const Vector3 w = random.unit();
        const Matrix3 rotation = exponential(e);
        const Vector3 ahead = rotation_vector(rotation * exponential(h * w));
        const Vector3 behind = rotation_vector(rotation * exponential(-h * w));
        BOOST_TEST((inverse_right_jacobian(e) * w - (ahead - behind) / (2.0 * h)).norm() <= 1e-8);
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(series_meets_the_closed_form) {
  const Vector3 axis(0.6, 0.0, 0.8);
  const Matrix3 change =
      inverse_right_jacobian(1.0000001e-3 * axis) - inverse_right_jacobian(0.9999999e-3 * axis);
  BOOST_TEST(change.norm() <= 1e-9);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
