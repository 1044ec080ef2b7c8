#pragma once

#include <tope/law/hierarchy.hpp>
#include <tope/law/stack_law.hpp>

namespace tope {

/// Limits by intermediate desired values (Lee, Mansard, Park 2012), as the paper builds them. Every limit row
/// with xi > 0 is in the stack, with the value (17), (27)
///   x_j^i = xi_j x_j + (1 - xi_j) T_j u_without_j.
/// Continuous for one row in transition when u_without_j holds all levels, otherwise not: kept for
/// comparison.
class IntermediateValues final : public StackLaw {
 public:
  enum class Scope {
    whole_stack,  ///< u_without_j holds the other limit rows and every task: (16)-(18)
    limit_rows,   ///< u_without_j holds the other limit rows alone: (26)-(29) to the letter
  };

  IntermediateValues(const Stack& stack, const Hierarchy::Options& options, Scope scope);

  void begin() override { hierarchy_.begin(); }
  /// Takes the limit rows from the stack's activations; selection.limits has no part in this law.
  void solve(const Stack& stack, const Selection& selection, Solution& solution) override;

 private:
  Hierarchy hierarchy_;
  Scope scope_;
  Selection inner_;
  Solution without_;
  Vector values_;
};

}  // namespace tope
