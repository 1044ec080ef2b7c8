// Motions through waypoints: they pass every point at its time, velocity and acceleration are the derivatives of what they
// say and continuous everywhere, both ends included, and no axes are special. Not here: tasks that follow them (task room).
#include "support/no_allocation.hpp"
#include "support/random.hpp"
#include "support/text.hpp"

#include <tope/reference/waypoints.hpp>

#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(waypoints)
namespace {

std::vector<double> random_times(Random& random, int count) {
  std::vector<double> times{random.uniform(-1.0, 1.0)};
  while (static_cast<int>(times.size()) < count) {
    times.push_back(times.back() + random.uniform(0.3, 1.5));
  }
  return times;
}

std::vector<PointWaypoint> random_points(Random& random, int count) {
  std::vector<PointWaypoint> waypoints;
  for (const double t : random_times(random, count)) {
    waypoints.push_back({t, random.vector(3)});
  }
  return waypoints;
}

/// Each turned by up to `step` from the one before.
std::vector<RotationWaypoint> random_rotations(Random& random, int count, double step) {
  std::vector<RotationWaypoint> waypoints;
  Matrix3 rotation = random.rotation();
  for (const double t : random_times(random, count)) {
    waypoints.push_back({t, rotation});
    rotation *= Eigen::AngleAxisd(random.uniform(0.0, step), random.unit()).toRotationMatrix();
  }
  return waypoints;
}

/// Times within, on and outside of the waypoints'.
template <typename Waypoint>
std::vector<double> times_around(const std::vector<Waypoint>& waypoints) {
  std::vector<double> times;
  const double first = waypoints.front().time - 0.5;
  const double last = waypoints.back().time + 0.5;
  for (int i = 0; i <= 200; ++i) {
    times.push_back(first + (last - first) * i / 200.0);
  }
  for (const Waypoint& waypoint : waypoints) {
    times.push_back(waypoint.time);
  }
  return times;
}

Vector3 unskew(const Matrix3& m) {
  return 0.5 * Vector3(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
}

}  // namespace

BOOST_AUTO_TEST_CASE(points_are_passed_at_their_times) {
  for (int count = 2; count <= 7; ++count) {
    Random random(count);
    const std::vector<PointWaypoint> waypoints = random_points(random, count);
    const Target<PointTarget> target = through(waypoints);
    for (const PointWaypoint& waypoint : waypoints) {
      BOOST_TEST((target.at(waypoint.time).position - waypoint.position).norm() <= 1e-12);
    }
    for (const PointWaypoint& end : {waypoints.front(), waypoints.back()}) {
      BOOST_TEST(target.at(end.time).velocity.norm() == 0.0);
      BOOST_TEST(target.at(end.time).acceleration.norm() == 0.0);
    }
    BOOST_TEST((target.at(waypoints.front().time - 9.0).position - waypoints.front().position).norm() == 0.0);
    BOOST_TEST((target.at(waypoints.back().time + 9.0).position - waypoints.back().position).norm() == 0.0);
  }
}

BOOST_AUTO_TEST_CASE(points_move_as_they_say_and_without_a_jump) {
  constexpr double h = 1e-5;
  for (int count = 2; count <= 7; ++count) {
    Random random(10 + count);
    const std::vector<PointWaypoint> waypoints = random_points(random, count);
    const Target<PointTarget> target = through(waypoints);
    double sharpest = 0.0;
    for (const double t : times_around(waypoints)) {
      const PointTarget ahead = target.at(t + h);
      const PointTarget behind = target.at(t - h);
      const PointTarget now = target.at(t);
      sharpest = std::max(sharpest, (ahead.acceleration - behind.acceleration).norm() / (2.0 * h));
      BOOST_TEST(((ahead.position - behind.position) / (2.0 * h) - now.velocity).norm() <= 1e-7);
      BOOST_TEST(((ahead.velocity - behind.velocity) / (2.0 * h) - now.acceleration).norm() <=
                 h * sharpest + 1e-9);  // a kink of the acceleration counts half
    }
    // were the acceleration to jump by 1 m/s2, this would be 5e4
    BOOST_TEST(sharpest <= 5e3);
  }
}

BOOST_AUTO_TEST_CASE(rotations_are_passed_at_their_times) {
  for (int count = 2; count <= 7; ++count) {
    Random random(20 + count);
    const std::vector<RotationWaypoint> waypoints = random_rotations(random, count, 1.5);
    const Target<RotationTarget> target = through(waypoints);
    for (const RotationWaypoint& waypoint : waypoints) {
      BOOST_TEST((target.at(waypoint.time).rotation - waypoint.rotation).norm() <= 1e-12);
    }
    for (const RotationWaypoint& end : {waypoints.front(), waypoints.back()}) {
      BOOST_TEST(target.at(end.time).angular_velocity.norm() == 0.0);
      BOOST_TEST(target.at(end.time).angular_acceleration.norm() == 0.0);
    }
  }
}

BOOST_AUTO_TEST_CASE(rotations_turn_as_they_say_and_without_a_jump) {
  constexpr double h = 1e-5;
  for (int count = 2; count <= 7; ++count) {
    Random random(30 + count);
    const std::vector<RotationWaypoint> waypoints = random_rotations(random, count, 1.5);
    const Target<RotationTarget> target = through(waypoints);
    double sharpest = 0.0;
    for (const double t : times_around(waypoints)) {
      const RotationTarget ahead = target.at(t + h);
      const RotationTarget behind = target.at(t - h);
      const RotationTarget now = target.at(t);
      const Matrix3 slope = (ahead.rotation - behind.rotation) / (2.0 * h);
      sharpest =
          std::max(sharpest, (ahead.angular_acceleration - behind.angular_acceleration).norm() / (2.0 * h));
      BOOST_TEST((now.rotation.transpose() * now.rotation - Matrix3::Identity()).norm() <= 1e-14);
      BOOST_TEST((unskew(slope * now.rotation.transpose()) - now.angular_velocity).norm() <= 1e-7);
      BOOST_TEST(((ahead.angular_velocity - behind.angular_velocity) / (2.0 * h) - now.angular_acceleration)
                     .norm() <= h * sharpest + 1e-9);
    }
    BOOST_TEST(sharpest <= 5e3);
  }
}

BOOST_AUTO_TEST_CASE(no_axes_are_special) {
  Random random(40);
  const std::vector<RotationWaypoint> waypoints = random_rotations(random, 5, 2.0);
  const Matrix3 world = random.rotation();
  const Matrix3 body = random.rotation();
  std::vector<RotationWaypoint> seen;
  for (const RotationWaypoint& waypoint : waypoints) {
    seen.push_back({waypoint.time, world * waypoint.rotation * body});
  }
  const Target<RotationTarget> target = through(waypoints);
  const Target<RotationTarget> other = through(seen);
  for (const double t : times_around(waypoints)) {
    BOOST_TEST((other.at(t).rotation - world * target.at(t).rotation * body).norm() <= 1e-12);
    BOOST_TEST((other.at(t).angular_velocity - world * target.at(t).angular_velocity).norm() <= 1e-11);
  }
}

BOOST_AUTO_TEST_CASE(straight_ways_stay_straight) {
  const Target<PointTarget> line =
      through(std::vector<PointWaypoint>{{0.0, Vector3::Zero()}, {2.0, Vector3(1.0, 0.0, -2.0)}});
  const Target<RotationTarget> turn = through(std::vector<RotationWaypoint>{
      {0.0, Matrix3::Identity()}, {2.0, Eigen::AngleAxisd(2.0, Vector3::UnitY()).toRotationMatrix()}});
  BOOST_TEST((line.at(1.0).position - Vector3(0.5, 0.0, -1.0)).norm() <= 1e-12);
  BOOST_TEST((turn.at(1.0).rotation - Eigen::AngleAxisd(1.0, Vector3::UnitY()).toRotationMatrix()).norm() <=
             1e-12);
  double last = -1.0;
  for (double t = 0.0; t <= 2.0; t += 0.01) {
    BOOST_TEST(line.at(t).position.x() >= last);  // never back
    last = line.at(t).position.x();
    BOOST_TEST((turn.at(t).rotation * Vector3::UnitY() - Vector3::UnitY()).norm() <= 1e-14);
  }
}

BOOST_AUTO_TEST_CASE(following_them_allocates_nothing) {
  Random random(41);
  const Target<PointTarget> points = through(random_points(random, 5));
  const Target<RotationTarget> rotations = through(random_rotations(random, 5, 1.0));
  const NoAllocation guard("waypoints");
  for (double t = -1.0; t < 6.0; t += 0.1) {
    points.at(t);
    rotations.at(t);
  }
}

BOOST_AUTO_TEST_CASE(bad_waypoints_are_refused) {
  const Vector3 origin = Vector3::Zero();
  const Matrix3 upright = Matrix3::Identity();
  const Matrix3 turned = Eigen::AngleAxisd(2.6, Vector3::UnitX()).toRotationMatrix();
  using Points = std::vector<PointWaypoint>;
  using Rotations = std::vector<RotationWaypoint>;
  check_error([&] { through(Points{{0.0, origin}}); }, {"at least 2 waypoints, got 1"});
  check_error([&] { through(Points{{0.0, origin}, {0.0, origin}}); }, {"waypoint 1", "later", "0.0"});
  check_error([&] { through(Points{{0.0, origin}, {NAN, origin}}); }, {"waypoint 1", "finite"});
  check_error([&] { through(Points{{0.0, origin}, {1.0, {0.0, NAN, 0.0}}}); }, {"waypoint 1", "finite"});
  check_error([&] { through(Rotations{{0.0, upright}, {1.0, 2.0 * upright}}); },
              {"waypoint 1", "not a rotation"});
  check_error([&] { through(Rotations{{0.0, upright}, {1.0, turned}}); }, {"waypoint 1", "2.5", "between"});
  const auto turn = [](double w, double x, double y, double z) {
    return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  };
  const Rotations swing{{0.01, upright},  // two quick turns after slow ones
                        {3.36, turn(0.76, -0.27, -0.26, 0.53)},
                        {10.25, turn(0.36, -0.44, -0.71, 0.42)},
                        {10.27, turn(-0.69, -0.24, -0.56, 0.39)},
                        {10.32, turn(0.09, -0.22, -0.75, 0.62)}};
  check_error([&] { through(swing); }, {"swing too far"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
