#include "waypoint_spline.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace tope {
namespace {

/// Knots of the spline, and which of them are waypoints.
struct Knots {
  std::vector<double> times;
  std::vector<int> waypoint;  // its number; -1: chosen by the spline
};

Knots knots_for(const std::vector<double>& times) {
  Knots knots;
  const std::size_t last = times.size() - 1;
  const int between = last == 1 ? 2 : 1;  // of an end piece
  for (std::size_t i = 0; i < last; ++i) {
    knots.times.push_back(times[i]);
    knots.waypoint.push_back(static_cast<int>(i));
    const bool at_end = i == 0 || i + 1 == last;
    for (int k = 1; at_end && k <= between; ++k) {
      knots.times.push_back(times[i] + (times[i + 1] - times[i]) * k / (between + 1.0));
      knots.waypoint.push_back(-1);
    }
  }
  knots.times.push_back(times[last]);
  knots.waypoint.push_back(static_cast<int>(last));
  return knots;
}

/// The linear equations for what the spline chooses: all inner rates, and the values at its own knots.
template <int D>
class Equations {
 public:
  using Values = WaypointSpline<D>::Values;

  Equations(const Knots& knots, const Values& waypoints)
      : knots_(knots),
        waypoints_(waypoints),
        count_(static_cast<int>(knots.times.size())),
        a_(Matrix::Zero(count_, count_)),
        b_(Eigen::Matrix<double, Eigen::Dynamic, D>::Zero(count_, D)),
        column_(knots.times.size(), -1) {
    int next = count_ - 2;  // behind the inner rates
    for (int i = 0; i < count_; ++i) {
      if (waypoint(i) < 0) {
        column_[static_cast<std::size_t>(i)] = next++;
      }
    }
    add_start_acceleration(0, 0, 1.0);
    add_end_acceleration(1, count_ - 2, 1.0);
    for (int i = 1; i + 1 < count_; ++i) {  // the acceleration is continuous
      add_end_acceleration(i + 1, i - 1, 1.0);
      add_start_acceleration(i + 1, i, -1.0);
    }
  }

  void solve(Values& values, Values& rates) const {
    const Eigen::Matrix<double, Eigen::Dynamic, D> x = a_.partialPivLu().solve(b_);
    values.resize(D, count_);
    rates = Values::Zero(D, count_);
    for (int i = 0; i < count_; ++i) {
      values.col(i) = waypoint(i) < 0 ? Eigen::Matrix<double, D, 1>(x.row(column(i)))
                                      : Eigen::Matrix<double, D, 1>(waypoints_.col(waypoint(i)));
    }
    rates.middleCols(1, count_ - 2) = x.topRows(count_ - 2).transpose();
  }

 private:
  int waypoint(int knot) const { return knots_.waypoint[static_cast<std::size_t>(knot)]; }
  int column(int knot) const { return column_[static_cast<std::size_t>(knot)]; }

  double duration(int piece) const {
    const auto i = static_cast<std::size_t>(piece);
    return knots_.times[i + 1] - knots_.times[i];
  }

  void add_value(int row, int knot, double factor) {
    if (waypoint(knot) < 0) {
      a_(row, column(knot)) += factor;
    } else {
      b_.row(row) -= factor * waypoints_.col(waypoint(knot)).transpose();
    }
  }

  void add_rate(int row, int knot, double factor) {
    if (knot > 0 && knot + 1 < count_) {  // the others are zero
      a_(row, knot - 1) += factor;
    }
  }

  /// factor * (6 (x1 - x0) / h^2 - (4 v0 + 2 v1) / h) of a piece.
  void add_start_acceleration(int row, int piece, double factor) {
    const double h = duration(piece);
    add_value(row, piece, -6.0 * factor / (h * h));
    add_value(row, piece + 1, 6.0 * factor / (h * h));
    add_rate(row, piece, -4.0 * factor / h);
    add_rate(row, piece + 1, -2.0 * factor / h);
  }

  /// factor * (6 (x0 - x1) / h^2 + (2 v0 + 4 v1) / h) of a piece.
  void add_end_acceleration(int row, int piece, double factor) {
    const double h = duration(piece);
    add_value(row, piece, 6.0 * factor / (h * h));
    add_value(row, piece + 1, -6.0 * factor / (h * h));
    add_rate(row, piece, 2.0 * factor / h);
    add_rate(row, piece + 1, 4.0 * factor / h);
  }

  const Knots& knots_;
  const Values& waypoints_;
  int count_;  // of knots, and of equations
  Matrix a_;
  Eigen::Matrix<double, Eigen::Dynamic, D> b_;
  std::vector<int> column_;  // of the value at a knot of the spline's own
};

}  // namespace

template <int D>
WaypointSpline<D>::WaypointSpline(const std::vector<double>& times, const Values& waypoints) {
  const Knots knots = knots_for(times);
  Equations<D>(knots, waypoints).solve(values_, rates_);
  knots_ = knots.times;
}

template <int D>
PathMotion<D> WaypointSpline<D>::at(double t) const {
  using Value = PathMotion<D>::Value;
  const Eigen::Index last = values_.cols() - 1;
  if (t <= knots_.front() || t >= knots_.back()) {
    return {values_.col(t <= knots_.front() ? 0 : last), Value::Zero(), Value::Zero()};
  }
  const auto next = std::upper_bound(knots_.begin(), knots_.end(), t);
  const Eigen::Index i = next - knots_.begin() - 1;
  const double h = *next - *(next - 1);
  const double s = (t - *(next - 1)) / h;
  const Value step = values_.col(i + 1) - values_.col(i);
  const Value v0 = h * rates_.col(i);
  const Value v1 = h * rates_.col(i + 1);
  const Value c = 3.0 * step - 2.0 * v0 - v1;
  const Value d = v0 + v1 - 2.0 * step;
  return {values_.col(i) + s * (v0 + s * (c + s * d)), (v0 + s * (2.0 * c + 3.0 * s * d)) / h,
          (2.0 * c + 6.0 * s * d) / (h * h)};
}

template class WaypointSpline<3>;
template class WaypointSpline<4>;

}  // namespace tope
