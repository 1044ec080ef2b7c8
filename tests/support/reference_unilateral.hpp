#pragma once

#include <tope/law/stack.hpp>
#include <tope/law/unilateral.hpp>

#include <vector>

namespace tope::test {

/// min |A z - r|^2 + mu |z|^2 subject to lower <= D z <= upper, by eiquadprog. Throws when it finds no
/// optimum.
Vector reference_bounded_least_squares(const Matrix& a, const Vector& r, double mu, const Matrix& d,
                                       const Vector& lower, const Vector& upper);

/// One level of the unilateral law as its definition says, all matrices dense.
struct ReferenceLevel {
  int level = 0;
  Matrix open;   ///< M as the level finds it (n x n)
  Vector lower;  ///< tightened bounds on [T; C] y (n + p), below level 0 less the slack
  Vector upper;
  double mu = 1.0;  ///< weight of |z|^2
  Matrix a;         ///< its tasks' rows (m x n), none at level 0
  Vector b;         ///< (m)
  Vector singular;  ///< singular values of A M
  Vector y;         ///< after the level
  Vector slack;     ///< s of level 0 (p)
};

/// T over C ((n + p) x n).
Matrix bounded_rows(const Stack& stack);

/// The unilateral law by singular value decompositions and eiquadprog, level by level from 0.
std::vector<ReferenceLevel> reference_unilateral(const Stack& stack, const Selection& selection,
                                                 const Unilateral::Options& options);

}  // namespace tope::test
