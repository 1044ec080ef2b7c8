#include "stream_follower.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tope {
namespace {

/// Where a point is that moved on for so many seconds.
PathMotion<3> moved(const StreamSample<3>& sample, double seconds) {
  return {sample.value + seconds * sample.velocity, sample.velocity, Vector3::Zero()};
}

/// The same for a quaternion: q' = w q / 2.
PathMotion<4> moved(const StreamSample<4>& sample, double seconds) {
  const double speed = sample.velocity.norm();
  const Vector3 axis = speed > 0.0 ? Vector3(sample.velocity / speed) : Vector3::UnitX();
  const Eigen::Quaterniond q =
      Eigen::Quaterniond(Eigen::AngleAxisd(speed * seconds, axis)) *
      Eigen::Quaterniond(sample.value[0], sample.value[1], sample.value[2], sample.value[3]);
  const Eigen::Quaterniond rate = Eigen::Quaterniond(0.0, 0.5 * sample.velocity.x(),
                                                     0.5 * sample.velocity.y(), 0.5 * sample.velocity.z()) *
                                  q;
  const Eigen::Vector4d value(q.w(), q.x(), q.y(), q.z());
  return {value, {rate.w(), rate.x(), rate.y(), rate.z()}, -0.25 * speed * speed * value};
}

void turn_towards(StreamSample<3>& /*sample*/, const Vector3& /*value*/) {}

/// Of a quaternion and its opposite, which are the same rotation, takes the nearer one.
void turn_towards(StreamSample<4>& sample, const Eigen::Vector4d& value) {
  if (sample.value.dot(value) < 0.0) {
    sample.value = -sample.value;
  }
}

}  // namespace

template <int D>
StreamFollower<D>::StreamFollower(const StreamSample<D>& start, const StreamOptions& options)
    : options_(options), sample_(start) {}

template <int D>
StreamFollower<D>::Piece StreamFollower<D>::piece_at(double t) const {
  if (t < end_of(Piece::before)) {
    return Piece::before;
  }
  return t < end_of(Piece::moving) ? Piece::moving : Piece::stopped;
}

template <int D>
double StreamFollower<D>::end_of(Piece piece) const {
  switch (piece) {
    case Piece::before:
      return sample_.time;
    case Piece::moving:
      return sample_.time + options_.hold;
    default:
      return std::numeric_limits<double>::infinity();
  }
}

template <int D>
PathMotion<D> StreamFollower<D>::goal_at(double t) const {
  if (piece_ == Piece::moving) {
    return moved(sample_, t - sample_.time);
  }
  return {moved(sample_, piece_ == Piece::before ? 0.0 : options_.hold).value, Value::Zero(), Value::Zero()};
}

template <int D>
PathMotion<D> StreamFollower<D>::motion_at(double t) const {
  const double s = t - begun_;
  const double k = options_.rate;
  const double decay = std::exp(-k * s);
  const Value p = a_ + s * (b_ + s * c_);
  const Value p_rate = b_ + 2.0 * s * c_;
  PathMotion<D> motion = goal_at(t);
  motion.value += decay * p;
  motion.rate += decay * (p_rate - k * p);
  motion.acceleration += decay * (2.0 * c_ - 2.0 * k * p_rate + k * k * p);
  return motion;
}

/// Another piece of the goal, or another goal; the motion goes on from where it is.
template <int D>
void StreamFollower<D>::begin(Piece piece, double t, const PathMotion<D>& motion) {
  const double k = options_.rate;
  piece_ = piece;
  begun_ = t;
  const PathMotion<D> goal = goal_at(t);
  const Value offset = motion.value - goal.value;
  const Value rate = motion.rate - goal.rate;
  a_ = offset;
  b_ = rate + k * offset;
  c_ = 0.5 * (motion.acceleration - goal.acceleration) + k * rate + 0.5 * k * k * offset;
}

template <int D>
void StreamFollower<D>::advance(double t) {
  if (t < now_) {  // another clock: from where it is
    begin(piece_at(t), t, motion());
  }
  while (end_of(piece_) <= t) {
    const double end = std::max(end_of(piece_), begun_);
    begin(piece_ == Piece::before ? Piece::moving : Piece::stopped, end, motion_at(end));
  }
  now_ = t;
}

template <int D>
void StreamFollower<D>::follow(StreamSample<D> sample) {
  const PathMotion<D> motion = motion_at(now_);
  turn_towards(sample, motion.value);
  sample_ = std::move(sample);
  begin(piece_at(now_), now_, motion);
}

template class StreamFollower<3>;
template class StreamFollower<4>;

}  // namespace tope
