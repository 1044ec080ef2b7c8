#pragma once

#include <tope/law/chain.hpp>
#include <tope/law/hierarchy.hpp>
#include <tope/law/limit_method.hpp>
#include <tope/law/multilinear.hpp>
#include <tope/law/smooth_unilateral.hpp>

#include <memory>
#include <optional>
#include <variant>

namespace tope {

struct LawOptions {
  LimitMethod method = LimitMethod::unilateral;
  Hierarchy::Options hierarchy{};
  Unilateral::Options unilateral{};
  std::optional<Smoothing> smoothing{};  ///< of the method `unilateral`
};

/// The complete law of one limit method: which phi(S), over which activations, blended how.
class Law {
 public:
  /// Reserves memory for stacks of this shape (size, levels, rows a task).
  Law(const Stack& stack, const LawOptions& options);

  /// Never allocates or throws.
  void solve(const Stack& stack, Solution& solution);

 private:
  /// Activations of the limit rows as the blend sees them.
  const Vector& blended_activation(const Stack& stack);

  LimitMethod method_;
  std::unique_ptr<StackLaw> phi_;
  std::variant<Chain, Multilinear> blend_;
  Vector activation_;
};

}  // namespace tope
