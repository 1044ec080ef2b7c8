#include <tope/law/intermediate_values.hpp>

#include <algorithm>

namespace tope {

IntermediateValues::IntermediateValues(const Stack& stack, const Hierarchy::Options& options, Scope scope)
    : hierarchy_(stack, options),
      scope_(scope),
      inner_(stack),
      without_(stack.size()),
      values_(Vector::Zero(stack.size())) {}

void IntermediateValues::solve(const Stack& stack, const Selection& selection, Solution& solution) {
  const auto n = static_cast<std::size_t>(stack.size());
  for (std::size_t j = 0; j < n; ++j) {
    inner_.limits[j] = stack.limit_activation[static_cast<Eigen::Index>(j)] > 0.0 ? 1 : 0;
  }
  if (scope_ == Scope::whole_stack) {
    std::copy(selection.tasks.begin(), selection.tasks.end(), inner_.tasks.begin());
  } else {
    std::fill(inner_.tasks.begin(), inner_.tasks.end(), 0);
  }
  int laws = 1;
  for (std::size_t j = 0; j < n; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    const double xi = stack.limit_activation[row];
    values_[row] = stack.limit_target[row];
    if (xi <= 0.0 || xi >= 1.0) {
      continue;
    }
    inner_.limits[j] = 0;
    hierarchy_.solve(stack, inner_, without_);
    inner_.limits[j] = 1;
    values_[row] = xi * stack.limit_target[row] + (1.0 - xi) * stack.motion.row(row).dot(without_.y);
    ++laws;
  }
  std::copy(selection.tasks.begin(), selection.tasks.end(), inner_.tasks.begin());
  hierarchy_.solve(stack, inner_, values_, solution);
  solution.laws = laws;
}

}  // namespace tope
