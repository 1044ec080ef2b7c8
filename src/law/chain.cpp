#include <tope/law/chain.hpp>

#include <algorithm>

namespace tope {

Chain::Chain(const Stack& stack) : selection_(stack), part_(stack.size()) {
  elements_.reserve(static_cast<std::size_t>(stack.size()) + stack.tasks.size());
}

void Chain::solve(const Stack& stack, const Vector& limit_activation, StackLaw& law, Solution& solution) {
  const int n = stack.size();
  elements_.clear();
  for (int j = 0; j < n; ++j) {
    elements_.push_back({limit_activation[j], j});
  }
  for (std::size_t i = 0; i < stack.tasks.size(); ++i) {
    elements_.push_back({stack.tasks[i].activation, n + static_cast<int>(i)});
  }
  std::sort(elements_.begin(), elements_.end(),
            [](const Element& a, const Element& b) { return a.activation > b.activation; });
  std::fill(selection_.limits.begin(), selection_.limits.end(), 0);
  std::fill(selection_.tasks.begin(), selection_.tasks.end(), 0);

  solution.set_zero();
  double current = 1.0;
  auto element = elements_.begin();
  while (current > 0.0) {
    const double next = element == elements_.end() ? 0.0 : element->activation;
    if (current > next) {
      law.solve(stack, selection_, part_);
      solution.add(current - next, part_);
    }
    current = next;
    for (; element != elements_.end() && element->activation == current; ++element) {
      if (element->index < n) {
        selection_.limits[static_cast<std::size_t>(element->index)] = 1;
      } else {
        selection_.tasks[static_cast<std::size_t>(element->index - n)] = 1;
      }
    }
  }
}

}  // namespace tope
