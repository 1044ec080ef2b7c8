#pragma once

#include "support/random.hpp"

#include <tope/law/stack.hpp>

#include <functional>
#include <vector>

namespace tope::test {

/// Largest change of a component of f between neighbours of a grid of `steps` equal steps from 0 to 1.
double largest_jump(const std::function<Vector(double)>& f, int steps);

/// Repeats: cut the interval in ten and go on with the part that changes most. Largest change after `rounds`
/// cuts; a jump keeps its size, a continuous function's change falls about tenfold a round.
double jump_left_after(const std::function<Vector(double)>& f, int steps, int rounds);

/// A random smooth path s -> stack, s in [0, 1], of constant shape. Activations run through 0, 1 and ties. On
/// a rank-changing path rows of one level become dependent, vanish, or fall together with rows of a higher
/// level.
class StackPath {
 public:
  StackPath(Random& random, int n, bool rank_changing);

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
};

}  // namespace tope::test
