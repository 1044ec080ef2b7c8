#pragma once

#include <tope/law/stack.hpp>

namespace tope {

/// S -> phi(S): a strict-priority law with exactly the selected limit rows and tasks. Never allocates or
/// throws.
class StackLaw {
 public:
  virtual ~StackLaw() = default;
  /// Starts a cycle: the stack has changed. What the selections have in common may be kept from here on.
  virtual void begin() {}
  virtual void solve(const Stack& stack, const Selection& selection, Solution& solution) = 0;
};

}  // namespace tope
