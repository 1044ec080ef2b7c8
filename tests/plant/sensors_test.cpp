// Sensors against motions whose readings are known: an ideal localiser, odometry along an arc and with wheels that do
// not follow the map, resolution, noise, latency, velocities. Not here: the simulator behind them (mujoco_test).
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/plant/sensors.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>

namespace tope::test {
namespace sensors {

constexpr double kPeriod = 1e-3;
using Localisation = SensorOptions::Localisation;

/// A robot whose base drives with constant speeds (v_x, v_y, yaw rate) along its own axes, and whose joint 5 turns.
struct Drive {
  Robot robot = youbot();
  Vector3 twist{0.2, -0.1, 0.8};
  double turn = 0.5;

  /// State and wheels at time t; `sideways` is what the wheels' map makes of v_y in truth.
  Vector state(double t, double sideways = 1.0) const {
    Vector q = Vector::Zero(8);
    const double yaw = twist[2] * t;
    const double ahead = twist[0] / twist[2];
    const double aside = sideways * twist[1] / twist[2];
    q.head(3) << ahead * std::sin(yaw) - aside * (1.0 - std::cos(yaw)),
        ahead * (1.0 - std::cos(yaw)) + aside * std::sin(yaw), yaw;
    q[7] = turn * t;
    return q;
  }
  MecanumBase::Wheels wheels(double t) const { return robot.base()->wheel_map() * twist * t; }

  Sensors after(const SensorOptions& options, double duration, double sideways = 1.0) const {
    Sensors sensors(robot, options, kPeriod);
    sensors.reset(state(0.0), wheels(0.0));
    for (int i = 1; i <= static_cast<int>(std::lround(duration / kPeriod)); ++i) {
      sensors.read(state(i * kPeriod, sideways), wheels(i * kPeriod));
    }
    return sensors;
  }
};

}  // namespace sensors

BOOST_FIXTURE_TEST_SUITE(sensors, Drive)

BOOST_AUTO_TEST_CASE(ideal_ones_tell_the_truth) {
  const Sensors seen = after({}, 2.0);
  BOOST_TEST((seen.position() - state(2.0)).norm() <= 1e-12);
  BOOST_TEST(std::abs(seen.velocity()[7] - turn) <= 1e-9);
  BOOST_TEST(std::abs(seen.velocity()[2] - twist[2]) <= 1e-9);
}

BOOST_AUTO_TEST_CASE(velocities_lag_by_their_filter) {
  const double time_constant = 0.05;
  const Sensors seen = after({.velocity_filter = time_constant}, time_constant);
  BOOST_TEST(std::abs(seen.velocity()[7] - turn * (1.0 - std::exp(-1.0))) <= 0.01 * turn);
  BOOST_TEST(std::abs(after({.velocity_filter = 0.0}, kPeriod).velocity()[7] - turn) <= 1e-12);
}

BOOST_AUTO_TEST_CASE(odometry_adds_up_an_arc) {
  const Sensors seen = after({.localisation = Localisation::odometry}, 4.0);
  BOOST_TEST((seen.position() - state(4.0)).norm() <= 1e-6);  // of 0.9 m: the chords of the arc
}

BOOST_AUTO_TEST_CASE(odometry_does_not_see_what_the_rollers_lose) {
  const double sideways = 0.955;
  const Sensors seen = after({.localisation = Localisation::odometry}, 4.0, sideways);
  const double drift = (seen.position() - state(4.0, sideways)).norm();
  const double expected = (state(4.0) - state(4.0, sideways)).norm();
  BOOST_TEST(expected > 5e-3);
  BOOST_TEST(std::abs(drift - expected) <= 1e-6);
}

BOOST_AUTO_TEST_CASE(encoders_have_their_resolution) {
  const double step = 0.01;
  const Vector seen = after({.encoder_step = step}, 1.0007).position();
  const double counts = seen[7] / step;
  BOOST_TEST(std::abs(counts - std::round(counts)) <= 1e-9);
  BOOST_TEST(std::abs(seen[7] - state(1.001)[7]) <= 0.5 * step + 1e-12);
  BOOST_TEST(std::abs(seen[0] - state(1.001)[0]) <= 1e-12);  // the localiser has none
}

BOOST_AUTO_TEST_CASE(noise_has_its_size_and_repeats) {
  const SensorOptions options{.encoder_noise = 1e-3, .localiser_noise = 2e-3, .seed = 5};
  const auto deviation = [&](int joint) {
    Sensors sensors(robot, options, kPeriod);
    sensors.reset(state(0.0), wheels(0.0));
    double squares = 0.0;
    for (int i = 0; i < 4000; ++i) {
      sensors.read(state(0.0), wheels(0.0));
      squares += sensors.position()[joint] * sensors.position()[joint];
    }
    return std::sqrt(squares / 4000);
  };
  BOOST_TEST(std::abs(deviation(7) - 1e-3) <= 5e-5);
  BOOST_TEST(std::abs(deviation(0) - 2e-3) <= 1e-4);
  BOOST_TEST(after(options, 0.1).position() == after(options, 0.1).position());
}

BOOST_AUTO_TEST_CASE(latency_shows_the_past) {
  const Sensors seen = after({.latency = 5e-3}, 1.0);
  BOOST_TEST((seen.position() - state(0.995)).norm() <= 1e-12);
  BOOST_TEST((after({.latency = 5e-3}, 4e-3).position() - state(0.0)).norm() <= 1e-12);
}

BOOST_AUTO_TEST_CASE(bad_options_are_refused) {
  const auto refused = [&](const SensorOptions& options, const std::string& name) {
    check_error([&] { Sensors(robot, options, kPeriod); }, {"plant: sensors: " + name, "negative"});
  };
  refused({.encoder_noise = -1.0}, "encoder_noise");
  refused({.encoder_step = -1.0}, "encoder_step");
  refused({.localiser_noise = -1.0}, "localiser_noise");
  refused({.velocity_filter = std::nan("")}, "velocity_filter");
  refused({.latency = -1.0}, "latency");
  const Robot no_wheels = Robot::from_urdf(source_path("robots/youbot/youbot.urdf"));
  check_error([&] { Sensors(no_wheels, {}, kPeriod); }, {"no mecanum_base"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
