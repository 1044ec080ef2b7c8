#include <tope/law/multilinear.hpp>

namespace tope {
namespace {

struct Transition {
  char* selected;
  double activation;
};

}  // namespace

Multilinear::Multilinear(const Stack& stack) : selection_(stack), part_(stack.size()), chain_(stack) {}

void Multilinear::solve(const Stack& stack, const Vector& limit_activation, StackLaw& law,
                        Solution& solution) {
  law.begin();
  std::array<Transition, max_transitions> transitions{};
  std::size_t count = 0;
  const auto classify = [&](double activation, char& selected) {
    selected = activation >= 1.0 ? 1 : 0;
    if (activation <= 0.0 || activation >= 1.0) {
      return;
    }
    if (count < transitions.size()) {
      transitions[count] = {&selected, activation};
    }
    ++count;
  };
  for (std::size_t j = 0; j < selection_.limits.size(); ++j) {
    classify(limit_activation[static_cast<Eigen::Index>(j)], selection_.limits[j]);
  }
  for (std::size_t i = 0; i < stack.tasks.size(); ++i) {
    classify(stack.tasks[i].activation, selection_.tasks[i]);
  }
  if (count > transitions.size()) {
    chain_.solve(stack, limit_activation, law, solution);
    solution.cut_off = true;
    return;
  }
  solution.set_zero();
  for (std::size_t subset = 0; subset < (std::size_t{1} << count); ++subset) {
    double weight = 1.0;
    for (std::size_t k = 0; k < count; ++k) {
      const bool in = ((subset >> k) & 1U) != 0U;
      *transitions[k].selected = in ? 1 : 0;
      weight *= in ? transitions[k].activation : 1.0 - transitions[k].activation;
    }
    law.solve(stack, selection_, part_);
    solution.add(weight, part_);
  }
}

}  // namespace tope
