#pragma once

#include <tope/law/hierarchy.hpp>

namespace tope::test {

/// What a hierarchy with its default options, fresh, gives for a selection.
inline Vector phi(const Stack& stack, const Selection& selection) {
  Hierarchy law(stack, {});
  Solution solution(stack.size());
  law.solve(stack, selection, solution);
  return solution.y;
}

}  // namespace tope::test
