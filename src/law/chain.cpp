#include <tope/law/chain.hpp>

#include <algorithm>

namespace tope {

Chain::Chain(const Stack& stack) : entered_(stack), present_(stack), part_(stack.size()) {
  elements_.reserve(static_cast<std::size_t>(stack.size()) + stack.tasks.size());
}

void Chain::solve(const Stack& stack, const Vector& limit_activation, StackLaw& law, Solution& solution) {
  law.begin();
  elements_.clear();
  const auto classify = [this](double activation, char& entered) {
    entered = activation >= 1.0 ? 1 : 0;
    if (activation > 0.0 && activation < 1.0) {
      elements_.push_back({activation, &entered});
    }
  };
  for (std::size_t j = 0; j < entered_.limits.size(); ++j) {
    classify(limit_activation[static_cast<Eigen::Index>(j)], entered_.limits[j]);
  }
  for (std::size_t i = 0; i < stack.tasks.size(); ++i) {
    classify(stack.tasks[i].activation, entered_.tasks[i]);
  }
  if (elements_.empty()) {
    present_.assign_present(stack, entered_);
    law.solve(stack, present_, solution);
    return;
  }
  std::sort(elements_.begin(), elements_.end(),
            [](const Element& a, const Element& b) { return a.activation > b.activation; });

  solution.set_zero();
  double current = 1.0;
  auto element = elements_.begin();
  while (current > 0.0) {
    const double next = element == elements_.end() ? 0.0 : element->activation;
    if (current > next) {
      present_.assign_present(stack, entered_);
      law.solve(stack, present_, part_);
      solution.add(current - next, part_);
    }
    current = next;
    for (; element != elements_.end() && element->activation == current; ++element) {
      *element->entered = 1;
    }
  }
}

}  // namespace tope
