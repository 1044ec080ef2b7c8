#pragma once

#include <tope/law/stack_law.hpp>

#include <vector>

namespace tope {

/// Blends phi(S) along the chain of the sorted activations (the Lovasz extension of S -> phi(S)):
///   u = sum_k (xi_(k) - xi_(k+1)) phi(S_k),  S_k the k largest, xi_(0) = 1, xi_(r+1) = 0.
/// Continuous, equal to phi where all activations are 0 or 1, exact for an element with xi = 1, strict
/// priority kept, with one law for each distinct value strictly between 0 and 1, and one more. Sorted
/// activations as in Generalized Hierarchical Control (Liu, Tan, Padois 2016), here on commands instead of
/// projectors. phi may be any function of S: a task that another one replaces is absent where that one is in S, so
/// that the task stays complete while it moves to another level or target.
class Chain {
 public:
  explicit Chain(const Stack& stack);

  /// Activations of the limit rows (n); those of the tasks are the stack's.
  void solve(const Stack& stack, const Vector& limit_activation, StackLaw& law, Solution& solution);

 private:
  struct Element {  // in transition
    double activation;
    char* entered;
  };

  Selection entered_;  // S
  Selection present_;
  Solution part_;
  std::vector<Element> elements_;
};

}  // namespace tope
