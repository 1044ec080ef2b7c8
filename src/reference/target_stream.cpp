#include "../common/require_positive.hpp"
#include "../common/rotation_check.hpp"
#include "quaternion_motion.hpp"
#include "sequence_lock.hpp"
#include "stream_follower.hpp"
#include "target_checks.hpp"

#include <tope/reference/target_stream.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace tope {
namespace {

StreamOptions checked(const std::string& who, const StreamOptions& options) {
  require_positive(who + ": rate [1/s]", options.rate);
  require_positive(who + ": hold [s]", options.hold);
  return options;
}

}  // namespace

/// What the writer and its readers share.
template <int D>
struct SharedStream {
  static constexpr int kNumbers = D + 4;
  using Numbers = SequenceLock<kNumbers>::Numbers;

  SharedStream(const StreamSample<D>& first, const StreamOptions& how) : start(first), options(how) {}

  /// Wait-free. False unless all numbers are finite and the time is later than the last one's.
  bool put(const StreamSample<D>& sample) noexcept {
    const bool later = sample.time > last_time;  // false for what is no number
    if (!later || !std::isfinite(sample.time) || !sample.value.allFinite() || !sample.velocity.allFinite()) {
      return false;
    }
    Numbers numbers;
    numbers[0] = sample.time;
    Eigen::Map<Eigen::Matrix<double, D, 1>>(numbers.data() + 1) = sample.value;
    Eigen::Map<Vector3>(numbers.data() + 1 + D) = sample.velocity;
    latest.write(numbers);
    last_time = sample.time;
    return true;
  }

  StreamSample<D> start;
  StreamOptions options;
  SequenceLock<kNumbers> latest;
  double last_time = -std::numeric_limits<double>::infinity();  // the writer's alone
};

namespace {

/// One target's view of a stream.
template <int D>
class StreamReader {
 public:
  explicit StreamReader(std::shared_ptr<const SharedStream<D>> stream)
      : stream_(std::move(stream)), follower_(stream_->start, stream_->options) {}

  /// Takes in a new sample once for each t, so that all who ask within a cycle hear the same.
  PathMotion<D> at(double t) {
    if (t != last_time_) {
      last_time_ = t;
      follower_.advance(t);
      typename SharedStream<D>::Numbers numbers;
      if (stream_->latest.read(seen_, numbers)) {
        follower_.follow({.time = numbers[0],
                          .value = Eigen::Map<Eigen::Matrix<double, D, 1>>(numbers.data() + 1),
                          .velocity = Eigen::Map<Vector3>(numbers.data() + 1 + D)});
      }
    }
    return follower_.motion();
  }

 private:
  std::shared_ptr<const SharedStream<D>> stream_;
  StreamFollower<D> follower_;
  std::uint64_t seen_ = 0;
  double last_time_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace

struct PointStream::Shared : SharedStream<3> {
  using SharedStream::SharedStream;
};

PointStream::PointStream(const Vector3& start, const StreamOptions& options)
    : shared_(std::make_shared<Shared>(StreamSample<3>{.value = start, .velocity = Vector3::Zero()},
                                       checked("PointStream", options))) {
  require_finite("PointStream: start", start);
}

bool PointStream::put(const PointSample& sample) noexcept {
  return shared_->put({.time = sample.time, .value = sample.position, .velocity = sample.velocity});
}

Target<PointTarget> PointStream::target() const {
  return Target<PointTarget>(std::function<PointTarget(double)>(
      [reader = StreamReader<3>(shared_)](double t) mutable { return point_on(reader.at(t)); }));
}

struct RotationStream::Shared : SharedStream<4> {
  using SharedStream::SharedStream;
};

RotationStream::RotationStream(const Matrix3& start, const StreamOptions& options) {
  checked("RotationStream", options);
  require_rotation("RotationStream: start", start);
  shared_ = std::make_shared<Shared>(
      StreamSample<4>{.value = quaternion_near(start, Eigen::Vector4d::UnitX()), .velocity = Vector3::Zero()},
      options);
}

bool RotationStream::put(const RotationSample& sample) noexcept {
  return is_rotation(sample.rotation) &&
         shared_->put({.time = sample.time,
                       .value = quaternion_near(sample.rotation, Eigen::Vector4d::UnitX()),
                       .velocity = sample.angular_velocity});
}

Target<RotationTarget> RotationStream::target() const {
  return Target<RotationTarget>(std::function<RotationTarget(double)>(
      [reader = StreamReader<4>(shared_)](double t) mutable { return rotation_on(reader.at(t)); }));
}

}  // namespace tope
