#pragma once

#include "path_motion.hpp"

#include <tope/reference/target_stream.hpp>

namespace tope {

/// A sample in D dimensions: of a point (3), or of a quaternion w, x, y, z (4), with its velocity or angular velocity.
template <int D>
struct StreamSample {
  double time = 0.0;  // [s]
  Eigen::Matrix<double, D, 1> value;
  Vector3 velocity;
};

/// The filter of PointStream and RotationStream: x = g + (a + b s + c s^2) exp(-rate s), s seconds after the piece of the
/// goal began, with a, b and c such that x, x' and x'' are continuous where g, g' or g'' jump.
template <int D>
class StreamFollower {
 public:
  StreamFollower(const StreamSample<D>& start, const StreamOptions& options);

  /// Goes on to time t [s], over what ends on the way.
  void advance(double t);
  /// Follows another sample from the time of the last advance().
  void follow(StreamSample<D> sample);
  /// At the time of the last advance().
  PathMotion<D> motion() const { return motion_at(now_); }

 private:
  using Value = typename PathMotion<D>::Value;
  enum class Piece {
    before,
    moving,
    stopped
  };  // of the goal: rests at the sample until its time, goes on, has stopped

  Piece piece_at(double t) const;
  double end_of(Piece piece) const;
  PathMotion<D> goal_at(double t) const;
  PathMotion<D> motion_at(double t) const;
  void begin(Piece piece, double t, const PathMotion<D>& motion);

  StreamOptions options_;
  StreamSample<D> sample_;
  Piece piece_ = Piece::stopped;
  double now_ = 0.0;
  double begun_ = 0.0;
  Value a_ = Value::Zero();
  Value b_ = Value::Zero();
  Value c_ = Value::Zero();
};

}  // namespace tope
