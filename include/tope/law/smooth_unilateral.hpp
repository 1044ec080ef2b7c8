#pragma once

#include <tope/law/unilateral.hpp>

#include <vector>

namespace tope {

/// How far the kinks of `unilateral` are smoothed.
struct Smoothing {
  int solutions = 3;    ///< averaged, 2 to 16; each costs a law of its own
  double spread = 3.0;  ///< s: their headrooms are between eta and (1 + s) eta

  /// What multiplies the headroom at a place x in [0, 1] of the spread.
  double factor(double x) const { return 1.0 + spread * x; }
  /// Errors: ConfigError unless 2 <= solutions <= 16 and spread > 0.
  void check() const;
};

/// The mean of `unilateral` over headrooms from eta to (1 + spread) eta, by Gauss-Legendre quadrature:
///   y = sum w_i unilateral(eta (1 + spread x_i)),  x_i, w_i the nodes and weights on [0, 1]
/// Where a bound becomes active the command of `unilateral` has a kink; here it has one at each node, and the largest is
/// w_i of that: 0.44 for three, 0.28 for five. A mean of points keeps every bound, and every task that all of them meet.
class SmoothUnilateral final : public StackLaw {
 public:
  /// Errors: those of Unilateral and of Smoothing::check.
  SmoothUnilateral(const Stack& stack, const Unilateral::Options& options, const Smoothing& smoothing);

  void solve(const Stack& stack, const Selection& selection, Solution& solution) override;

 private:
  struct Node {
    double weight;
    Unilateral law;
  };

  std::vector<Node> nodes_;
  Solution part_;
};

}  // namespace tope
