// Streams of samples: the filter against its closed form, continuity of position, velocity and acceleration, lag, hold, what
// put() refuses, and reading while another thread writes. Not here: tasks that follow streams (task room).
#include "../../src/reference/sequence_lock.hpp"
#include "support/no_allocation.hpp"
#include "support/random.hpp"
#include "support/text.hpp"

#include <tope/reference/target_stream.hpp>

#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <thread>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(target_stream)
namespace {

constexpr double kRate = 20.0;  // 1/s
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Matrix3 turn(const Vector3& rotation_vector) {
  const double angle = rotation_vector.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix()
                     : Matrix3::Identity().eval();
}

double angle_between(const Matrix3& a, const Matrix3& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

Vector3 unskew(const Matrix3& m) {
  return 0.5 * Vector3(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_step_is_followed_by_three_poles) {
  PointStream stream(Vector3::Zero());
  const Target<PointTarget> target = stream.target();
  const Vector3 to(1.0, -2.0, 0.5);
  BOOST_TEST(target.at(3.0).position.norm() == 0.0);
  BOOST_TEST(stream.put({.time = 3.0, .position = to}));
  BOOST_TEST(target.at(3.001).position.norm() == 0.0);  // seen now
  for (int i = 1; i < 1000; ++i) {
    const double s = kRate * 1e-3 * i;
    const PointTarget now = target.at(3.001 + 1e-3 * i);
    const double left = (1.0 + s + 0.5 * s * s) * std::exp(-s);
    BOOST_TEST((now.position - (1.0 - left) * to).norm() <= 1e-12);
    BOOST_TEST((now.velocity - 0.5 * kRate * s * s * std::exp(-s) * to).norm() <= 1e-11);
  }
  const double settled = 6.3 / kRate;  // as its comment says
  PointStream again(Vector3::Zero());
  const Target<PointTarget> other = again.target();
  BOOST_TEST(again.put({.time = 1.0, .position = Vector3::UnitX()}));
  other.at(1.0);
  BOOST_TEST(std::abs(other.at(1.0 + settled).position.x() - 0.95) <= 1e-3);
}

BOOST_AUTO_TEST_CASE(points_move_without_a_jump) {
  constexpr double h = 1e-4;
  Random random(1);
  PointStream stream(Vector3(random.vector(3)));
  const Target<PointTarget> target = stream.target();
  PointTarget last = target.at(0.0);
  double next = 0.01;
  double sharpest = 0.0;
  double fastest = 0.0;
  for (int i = 1; i < 30000; ++i) {
    const double t = h * i;
    if (t > next) {  // late by up to 20 ms, early by up to 10 ms, farther apart than the hold at times
      BOOST_TEST(stream.put({.time = std::max(t + random.uniform(-0.02, 0.01), next - 0.01 + 1e-9),
                             .position = random.vector(3, 0.1),
                             .velocity = random.vector(3, 0.5)}));
      next = t + random.uniform(0.03, 0.3);
    }
    const PointTarget now = target.at(t);
    // trapezoidal rule between two moments
    BOOST_TEST((now.position - last.position - 0.5 * h * (now.velocity + last.velocity)).norm() <= 1e-8);
    BOOST_TEST((now.velocity - last.velocity - 0.5 * h * (now.acceleration + last.acceleration)).norm() <=
               1e-5);
    sharpest = std::max(sharpest, (now.acceleration - last.acceleration).norm());
    fastest = std::max(fastest, now.acceleration.norm());
    last = now;
  }
  BOOST_TEST(fastest > 5.0);                           // m/s2
  BOOST_TEST(sharpest <= 10.0 * kRate * h * fastest);  // in proportion to the step
}

BOOST_AUTO_TEST_CASE(rotations_turn_without_a_jump) {
  constexpr double h = 1e-4;
  Random random(2);
  RotationStream stream(random.rotation());
  const Target<RotationTarget> target = stream.target();
  RotationTarget last = target.at(0.0);
  double next = 0.01;
  double sharpest = 0.0;
  double fastest = 0.0;
  for (int i = 1; i < 20000; ++i) {
    const double t = h * i;
    if (t > next) {
      BOOST_TEST(stream.put({.time = t,
                             .rotation = last.rotation * turn(random.vector(3, 0.5)),
                             .angular_velocity = random.vector(3)}));
      next = t + random.uniform(0.03, 0.3);
    }
    const RotationTarget now = target.at(t);
    const Vector3 turned =
        unskew((now.rotation - last.rotation) * (0.5 * (now.rotation + last.rotation)).transpose());
    BOOST_TEST((turned - 0.5 * h * (now.angular_velocity + last.angular_velocity)).norm() <= 1e-8);
    BOOST_TEST((now.angular_velocity - last.angular_velocity -
                0.5 * h * (now.angular_acceleration + last.angular_acceleration))
                   .norm() <= 1e-4);
    sharpest = std::max(sharpest, (now.angular_acceleration - last.angular_acceleration).norm());
    fastest = std::max(fastest, now.angular_acceleration.norm());
    last = now;
  }
  BOOST_TEST(fastest > 20.0);  // rad/s2
  BOOST_TEST(sharpest <= 10.0 * kRate * h * fastest);
}

BOOST_AUTO_TEST_CASE(constant_velocity_has_no_lag) {
  const Vector3 velocity(0.3, -0.2, 0.1);
  const Vector3 spin(0.4, 0.9, -0.3);
  PointStream points(Vector3::Zero());
  RotationStream rotations(Matrix3::Identity());
  const Target<PointTarget> point = points.target();
  const Target<RotationTarget> rotation = rotations.target();
  for (int i = 0; i <= 3000; ++i) {
    const double t = 1e-3 * i;
    if (i % 33 == 0) {
      BOOST_TEST(points.put({.time = t, .position = t * velocity, .velocity = velocity}));
      BOOST_TEST(rotations.put({.time = t, .rotation = turn(t * spin), .angular_velocity = spin}));
    }
    const PointTarget p = point.at(t);
    const RotationTarget r = rotation.at(t);
    if (i > 2000) {
      BOOST_TEST((p.position - t * velocity).norm() <= 1e-12);
      BOOST_TEST((p.velocity - velocity).norm() <= 1e-11);
      BOOST_TEST(angle_between(r.rotation, turn(t * spin)) <= 1e-7);
      BOOST_TEST((r.angular_velocity - spin).norm() <= 1e-10);
    }
  }
}

BOOST_AUTO_TEST_CASE(constant_acceleration_has_the_lag_that_is_stated) {
  constexpr double a = 1.0;  // m/s2
  PointStream stream(Vector3::Zero());
  const Target<PointTarget> target = stream.target();
  for (int i = 0; i <= 20000; ++i) {
    const double t = 1e-4 * i;
    BOOST_TEST(stream.put(
        {.time = t, .position = 0.5 * a * t * t * Vector3::UnitX(), .velocity = a * t * Vector3::UnitX()}));
    target.at(t);
  }
  const double lag = 0.5 * a * 4.0 - target.at(2.0).position.x();
  BOOST_TEST(std::abs(lag - 3.0 * a / (kRate * kRate)) <= 1e-4);
}

BOOST_AUTO_TEST_CASE(target_stops_when_no_sample_comes) {
  const Vector3 velocity(0.5, 0.0, 0.0);
  PointStream stream(Vector3::Zero(), {.rate = 20.0, .hold = 0.2});
  const Target<PointTarget> target = stream.target();
  BOOST_TEST(stream.put({.time = 1.0, .position = Vector3::Zero(), .velocity = velocity}));
  target.at(1.0);
  double farthest = 0.0;
  for (double t = 1.0; t < 3.0; t += 1e-3) {
    farthest = std::max(farthest, target.at(t).position.x());
  }
  BOOST_TEST((target.at(3.0).position - 0.2 * velocity).norm() <= 1e-9);
  BOOST_TEST(target.at(3.0).velocity.norm() <= 1e-9);
  BOOST_TEST(farthest <= 0.2 * velocity.x() + velocity.x() / kRate);  // swings beyond it a little
}

BOOST_AUTO_TEST_CASE(what_is_read_does_not_depend_on_when) {
  Random random(3);
  PointStream stream(Vector3::Zero());
  const Target<PointTarget> often = stream.target();
  const Target<PointTarget> rarely = stream.target();
  for (int i = 0; i < 200; ++i) {
    const double t = 1.0 + 0.05 * i;
    if (i % 4 == 0) {
      BOOST_TEST(stream.put({.time = t + random.uniform(-0.02, 0.02),
                             .position = random.vector(3),
                             .velocity = random.vector(3)}));
    }
    const PointTarget one = often.at(t);
    const PointTarget other = rarely.at(t);
    BOOST_TEST((one.position - other.position).norm() <= 1e-12);
    BOOST_TEST((one.acceleration - other.acceleration).norm() <= 1e-9);
    for (int k = 1; k < 50; ++k) {
      often.at(t + 1e-3 * k);
    }
  }
}

BOOST_AUTO_TEST_CASE(one_cycle_hears_one_answer) {
  PointStream stream(Vector3::Zero());
  const Target<PointTarget> target = stream.target();
  BOOST_TEST(stream.put({.time = 0.0, .position = Vector3::UnitX()}));
  target.at(0.0);
  const PointTarget first = target.at(0.1);
  BOOST_TEST(stream.put({.time = 0.1, .position = Vector3::UnitY(), .velocity = Vector3::UnitZ()}));
  BOOST_TEST((target.at(0.1).position == first.position));
  BOOST_TEST((target.at(0.1).acceleration == first.acceleration));
  const Target<PointTarget> copy = target;  // goes on alike
  BOOST_TEST((copy.at(0.2).position == target.at(0.2).position));
  BOOST_TEST(target.at(0.3).position.y() > 0.0);
}

BOOST_AUTO_TEST_CASE(a_clock_set_back_is_survived) {
  PointStream stream(Vector3::Zero());
  const Target<PointTarget> target = stream.target();
  BOOST_TEST(stream.put({.time = 5.0, .position = Vector3::UnitX(), .velocity = Vector3::UnitY()}));
  target.at(5.0);
  const Vector3 before = target.at(5.05).position;
  BOOST_TEST((target.at(-100.0).position - before).norm() <= 1e-12);
  BOOST_TEST((target.at(-99.0).position - Vector3::UnitX()).norm() <= 1e-6);  // the sample's time is to come
}

BOOST_AUTO_TEST_CASE(bad_samples_are_refused_and_change_nothing) {
  PointStream points(Vector3::Zero());
  const Target<PointTarget> point = points.target();
  BOOST_TEST(points.put({.time = 1.0, .position = Vector3::UnitX()}));
  BOOST_TEST(!points.put({.time = 1.0, .position = Vector3::UnitY()}));
  BOOST_TEST(!points.put({.time = 0.5, .position = Vector3::UnitY()}));
  BOOST_TEST(!points.put({.time = kNan, .position = Vector3::UnitY()}));
  BOOST_TEST(!points.put({.time = kInfinity, .position = Vector3::UnitY()}));
  BOOST_TEST(!points.put({.time = 2.0, .position = Vector3(0.0, kNan, 0.0)}));
  BOOST_TEST(
      !points.put({.time = 2.0, .position = Vector3::Zero(), .velocity = Vector3(kInfinity, 0.0, 0.0)}));
  point.at(1.0);
  BOOST_TEST((point.at(3.0).position - Vector3::UnitX()).norm() <= 1e-9);
  RotationStream rotations(Matrix3::Identity());
  const Target<RotationTarget> rotation = rotations.target();
  BOOST_TEST(!rotations.put({.time = 1.0, .rotation = 1.1 * Matrix3::Identity()}));
  BOOST_TEST(!rotations.put({.time = 1.0, .rotation = Matrix3::Constant(kNan)}));
  BOOST_TEST(!rotations.put({.time = 1.0, .angular_velocity = Vector3(kNan, 0.0, 0.0)}));
  BOOST_TEST((rotation.at(2.0).rotation == Matrix3::Identity()));
  BOOST_TEST(rotations.put({.time = 1.0, .rotation = turn(Vector3::UnitX())}));
  check_error([] { PointStream{Vector3(kNan, 0.0, 0.0)}; }, {"PointStream: start", "finite"});
  check_error([] { PointStream(Vector3::Zero(), {.rate = 0.0}); }, {"PointStream: rate", "positive"});
  check_error([] { RotationStream(Matrix3::Identity(), {.hold = kInfinity}); },
              {"RotationStream: hold", "finite"});
  check_error([] { RotationStream{Matrix3::Zero()}; }, {"RotationStream: start", "not a rotation"});
}

BOOST_AUTO_TEST_CASE(streams_allocate_nothing) {
  PointStream points(Vector3::Zero());
  RotationStream rotations(Matrix3::Identity());
  const Target<PointTarget> point = points.target();
  const Target<RotationTarget> rotation = rotations.target();
  const NoAllocation guard("streams");
  bool taken = true;
  for (int i = 0; i < 1000; ++i) {
    const double t = 1e-3 * i;
    taken = taken && points.put({.time = t, .position = Vector3::Constant(t)}) &&
            rotations.put({.time = t, .angular_velocity = Vector3::UnitX()});
    point.at(t);
    rotation.at(t);
  }
  BOOST_TEST(taken);
}

BOOST_AUTO_TEST_CASE(threads_read_whole_samples_while_another_writes) {
  constexpr int reads = 100000;
  PointStream stream(Vector3::Zero());
  std::atomic<int> reading{2};
  std::atomic<int> torn{0};
  const auto read = [&] {
    const Target<PointTarget> target = stream.target();
    double last = 0.0;
    for (int moves = 0, i = 0; moves < reads; ++i) {
      const PointTarget now = target.at(1e-5 * i);
      // samples have three equal coordinates; so has all that is made of whole ones
      torn += now.position.x() != now.position.y() || now.position.y() != now.position.z() ||
                      now.velocity.x() != now.velocity.z()
                  ? 1
                  : 0;
      moves += now.position.x() != last ? 1 : 0;
      last = now.position.x();
    }
    --reading;
  };
  std::thread one(read);
  std::thread other(read);
  int refused = 0;
  for (int i = 0; reading > 0; ++i) {
    const Vector3 place = Vector3::Constant(std::sin(1e-3 * i));
    refused += stream.put({.time = 1e-5 * i, .position = place, .velocity = 0.1 * place}) ? 0 : 1;
  }
  one.join();
  other.join();
  BOOST_TEST(torn == 0);
  BOOST_TEST(refused == 0);
}

BOOST_AUTO_TEST_CASE(a_read_that_meets_a_write_is_no_read) {
  constexpr int numbers = 256;  // enough for every other read to meet one
  SequenceLock<numbers> lock;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    SequenceLock<numbers>::Numbers written;
    for (int i = 1; !done; ++i) {
      written.fill(i);
      lock.write(written);
      std::this_thread::yield();
    }
  });
  SequenceLock<numbers>::Numbers seen{};
  std::uint64_t version = 0;
  int torn = 0;
  double last = 0.0;
  int back = 0;
  for (int whole = 0; whole < 200000;) {
    if (lock.read(version, seen)) {
      ++whole;
      torn += std::any_of(seen.begin(), seen.end(), [&](double value) { return value != seen[0]; }) ? 1 : 0;
      back += seen[0] <= last ? 1 : 0;
      last = seen[0];
    } else {
      std::this_thread::yield();  // to the writer, where cores are scarce
    }
  }
  done = true;
  writer.join();
  BOOST_TEST(torn == 0);
  BOOST_TEST(back == 0);  // every read is a newer one
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
