// MecanumBase: (2)-(3) of the paper by their numbers, round trips between base and wheels, what rotors add.
// Not here: torques of single wheels.
#include "support/random.hpp"
#include "support/text.hpp"

#include <tope/robot/mecanum_base.hpp>

#include <Eigen/QR>
#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(mecanum_base)
namespace {

const MecanumBaseOptions youbot_base{.joints = {0, 1, 2},
                                     .wheel_radius = 0.0475,
                                     .half_wheelbase = 0.235,
                                     .half_track = 0.15,
                                     .wheel_effort_limit = 2.137,
                                     .wheel_rotor_inertia = 0.00901};

}  // namespace

BOOST_AUTO_TEST_CASE(wheel_map_is_the_papers) {
  const MecanumBase base(youbot_base);
  const double k = 0.235 + 0.15;
  MecanumBase::WheelMap expected;
  expected << 1.0, -1.0, -k, 1.0, 1.0, k, 1.0, 1.0, -k, 1.0, -1.0, k;
  BOOST_TEST((0.0475 * base.wheel_map() - expected).norm() <= 1e-14);
  const Eigen::Vector4d null(1.0, 1.0, -1.0, -1.0);  // torques that cancel
  BOOST_TEST((base.wheel_map().transpose() * null).norm() <= 1e-12);
}

BOOST_AUTO_TEST_CASE(pseudo_inverse_round_trips) {
  const MecanumBase base(youbot_base);
  const Eigen::Matrix<double, 3, 4> inverse =
      Matrix(base.wheel_map()).completeOrthogonalDecomposition().pseudoInverse();
  BOOST_TEST((inverse * base.wheel_map() - Eigen::Matrix3d::Identity()).norm() <= 1e-13);
  Random random(1);
  const Eigen::Vector3d wrench = random.vector(3);
  const Eigen::Vector4d torques =
      inverse.transpose() * wrench;  // minimum-norm wheel torques of a base wrench
  BOOST_TEST((base.wheel_map().transpose() * torques - wrench).norm() <= 1e-12);
}

BOOST_AUTO_TEST_CASE(wheel_speeds_give_the_velocity_back) {
  MecanumBaseOptions options = youbot_base;
  options.joints = {4, 0, 2};  // x, y and yaw anywhere in the robot
  const MecanumBase base(options);
  const Matrix map = base.wheel_map();
  for (int seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const Vector v = random.vector(6);
    const double yaw = random.uniform(-4.0, 4.0);
    const Vector twist = map.completeOrthogonalDecomposition().solve(Vector(base.wheel_speeds(v, yaw)));
    const double c = std::cos(yaw);
    const double s = std::sin(yaw);
    BOOST_TEST(std::abs(c * twist[0] - s * twist[1] - v[4]) <= 1e-12);
    BOOST_TEST(std::abs(s * twist[0] + c * twist[1] - v[0]) <= 1e-12);
    BOOST_TEST(std::abs(twist[2] - v[2]) <= 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(forward_rolls_every_wheel_forward) {
  const MecanumBase base(youbot_base);
  const MecanumBase::Wheels forward = base.wheel_speeds(Eigen::Vector3d(0.2, 0.0, 0.0), 0.0);
  BOOST_TEST((forward.array() - 0.2 / 0.0475).abs().maxCoeff() <= 1e-12);
  const MecanumBase::Wheels turned = base.wheel_speeds(Eigen::Vector3d(0.0, 0.2, 0.0), std::acos(-1.0) / 2.0);
  BOOST_TEST((turned - forward).norm() <= 1e-12);
  const MecanumBase::Wheels left_turn = base.wheel_speeds(Eigen::Vector3d(0.0, 0.0, 0.5), 0.0);
  BOOST_TEST((left_turn[0] < 0.0 && left_turn[1] > 0.0 && left_turn[2] < 0.0 && left_turn[3] > 0.0));
}

BOOST_AUTO_TEST_CASE(twist_and_to_world_turn_wheel_speeds_back_into_motion) {
  const MecanumBase base(youbot_base);
  Random random(14);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector v = random.vector(3);
    const double yaw = random.uniform(-3.0, 3.0);
    const Eigen::Vector4d slipping(1.0, 1.0, -1.0, -1.0);  // speeds that no motion has
    const Eigen::Vector3d twist = base.twist(base.wheel_speeds(v, yaw) + random.normal() * slipping);
    BOOST_TEST((MecanumBase::to_world(twist, yaw) - v).norm() <= 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(wheel_torques_follow_the_distribution) {
  const MecanumBase base(youbot_base);
  const Eigen::Vector3d wrench(30.0, 20.0, 10.0);
  const auto torques = [&](WheelDistribution distribution) {
    return base.wheel_torques(wrench, distribution);
  };
  BOOST_TEST(torques(WheelDistribution::minimum_norm) == base.minimum_norm_torques(wrench));
  BOOST_TEST(torques(WheelDistribution::minimum_peak) == base.minimum_peak_torques(wrench));
  BOOST_TEST(base.minimum_norm_torques(wrench) != base.minimum_peak_torques(wrench));
}

BOOST_AUTO_TEST_CASE(rotors_add_their_reflected_inertia) {
  const MecanumBase base(youbot_base);
  const Matrix map = base.wheel_map();
  const Vector expected = (0.00901 * map.transpose() * map).diagonal();
  BOOST_TEST((base.reflected_inertia() - expected).norm() <= 1e-12);
  BOOST_TEST((map.transpose() * map - Matrix(expected.asDiagonal()) / 0.00901).norm() <=
             1e-9);  // nothing off it
}

BOOST_AUTO_TEST_CASE(bad_geometry_is_refused) {
  for (double MecanumBaseOptions::* member :
       {&MecanumBaseOptions::wheel_radius, &MecanumBaseOptions::half_wheelbase,
        &MecanumBaseOptions::half_track}) {
    for (const double bad : {0.0, -0.1, std::nan("")}) {
      MecanumBaseOptions options = youbot_base;
      options.*member = bad;
      check_error([&] { const MecanumBase base(options); }, {"mecanum base", "positive"});
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
