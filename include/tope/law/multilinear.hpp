#pragma once

#include <tope/law/chain.hpp>
#include <tope/law/stack_law.hpp>

#include <array>

namespace tope {

/// Blends phi(S) over every subset S: u = sum_S prod_{j in S} xi_j prod_{j not in S} (1 - xi_j) phi(S). What
/// the recursive form of the intermediate desired values equals; 2^r laws for r elements in transition.
/// Beyond max_transitions it hands over to the chain for that cycle and says so (Solution::cut_off).
class Multilinear {
 public:
  static constexpr int max_transitions = 10;

  explicit Multilinear(const Stack& stack);

  /// Activations of the limit rows (n); those of the tasks are the stack's.
  void solve(const Stack& stack, const Vector& limit_activation, StackLaw& law, Solution& solution);

 private:
  Selection entered_;  // S
  Selection present_;
  Solution part_;
  Chain chain_;
};

}  // namespace tope
