#pragma once

#include <tope/law/stack.hpp>

namespace tope::test {

struct ReferenceHierarchy {
  Vector y;
  /// Least share rho that is left of any task direction that is not lost altogether.
  double smallest_share = 1.0;
};

/// The undamped hierarchy of equalities, written another way than the library: null-space bases and
/// minimum-norm solutions from dense singular value decompositions, conflicting rows weighed by B^(-1/2), B =
/// A A^T + epsilon^2 I.
ReferenceHierarchy reference_hierarchy(const Stack& stack, const Selection& selection,
                                       const Vector& limit_target, double epsilon);
ReferenceHierarchy reference_hierarchy(const Stack& stack, const Selection& selection, double epsilon);

}  // namespace tope::test
