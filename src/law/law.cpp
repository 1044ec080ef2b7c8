#include <tope/law/intermediate_values.hpp>
#include <tope/law/law.hpp>

namespace tope {
namespace {

std::unique_ptr<StackLaw> make_phi(const Stack& stack, const LawOptions& options) {
  switch (options.method) {
    case LimitMethod::unilateral:
      if (options.smoothing) {
        return std::make_unique<SmoothUnilateral>(stack, options.unilateral, *options.smoothing);
      }
      return std::make_unique<Unilateral>(stack, options.unilateral);
    case LimitMethod::intermediate:
      return std::make_unique<IntermediateValues>(stack, options.hierarchy,
                                                  IntermediateValues::Scope::whole_stack);
    case LimitMethod::paper:
      return std::make_unique<IntermediateValues>(stack, options.hierarchy,
                                                  IntermediateValues::Scope::limit_rows);
    default:
      return std::make_unique<Hierarchy>(stack, options.hierarchy);
  }
}

std::variant<Chain, Multilinear> make_blend(const Stack& stack, LimitMethod method) {
  if (method == LimitMethod::multilinear) {
    return Multilinear(stack);
  }
  return Chain(stack);
}

}  // namespace

Law::Law(const Stack& stack, const LawOptions& options)
    : method_(options.method),
      phi_(make_phi(stack, options)),
      blend_(make_blend(stack, options.method)),
      activation_(Vector::Zero(stack.size())) {}

const Vector& Law::blended_activation(const Stack& stack) {
  switch (method_) {
    case LimitMethod::chain:
    case LimitMethod::multilinear:
      return stack.limit_activation;
    case LimitMethod::switching:
    case LimitMethod::potential_field:
      activation_ = (stack.limit_activation.array() > 0.0).cast<double>();
      return activation_;
    default:
      return activation_;  // zero: phi treats the limits itself, or there are none
  }
}

void Law::solve(const Stack& stack, Solution& solution) {
  const Vector& activation = blended_activation(stack);
  std::visit([&](auto& blend) { blend.solve(stack, activation, *phi_, solution); }, blend_);
}

}  // namespace tope
