#pragma once

#include "support/random.hpp"

#include <tope/law/stack.hpp>

#include <functional>
#include <vector>

namespace tope::test {

/// Follows the fifty of `steps` equal steps from 0 to 1 on which f changes most, and repeats: cut in ten,
/// go on with the part that changes most. Largest change of a component at first and after each round: it
/// falls tenfold a round where f is continuous, once the steps are short beside f's kinks, and stays where
/// f jumps.
std::vector<double> zoomed_changes(const std::function<Vector(double)>& f, int steps, int rounds);

/// Checks that f is continuous on [0, 1]: from steps of 1e-8 to steps of 1e-9 the largest change falls
/// about tenfold, and what is left of the largest change is next to nothing.
void check_continuity(const std::function<Vector(double)>& f);

/// A random smooth path s -> stack, s in [0, 1], of constant shape. Activations run through 0, 1 and ties. On
/// a rank-changing path rows of one level become dependent, vanish, or fall together with rows of a higher
/// level. Inequality rows turn, some are violated at zero for a while, and two of them come to contradict each other.
class StackPath {
 public:
  StackPath(Random& random, int n, bool rank_changing, int inequalities = 0);

  Stack at(double s) const;

 private:
  struct Curve {
    Matrix centre;
    Matrix amplitude;
    double frequency;
    double phase;
    Matrix at(double s) const;
  };

  static Curve curve(Random& random, Eigen::Index rows, Eigen::Index cols, double size);

  int n_;
  bool rank_changing_;
  Matrix motion_;
  Curve activation_;
  Curve target_;
  Curve room_;
  std::vector<Curve> a_;
  std::vector<Curve> b_;
  Curve inequality_;
  Curve inequality_lower_;
};

}  // namespace tope::test
