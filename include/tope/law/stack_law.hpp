#pragma once

#include <tope/law/stack.hpp>

namespace tope {

/// S -> phi(S): a strict-priority law with exactly the selected limit rows and tasks. Never allocates or
/// throws.
class StackLaw {
 public:
  virtual ~StackLaw() = default;
  virtual void solve(const Stack& stack, const Selection& selection, Solution& solution) = 0;
};

}  // namespace tope
