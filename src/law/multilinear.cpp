#include <tope/law/multilinear.hpp>

namespace tope {
namespace {

struct Transition {
  char* entered;
  double activation;
};

}  // namespace

Multilinear::Multilinear(const Stack& stack)
    : entered_(stack), present_(stack), part_(stack.size()), chain_(stack) {}

void Multilinear::solve(const Stack& stack, const Vector& limit_activation, StackLaw& law,
                        Solution& solution) {
  law.begin();
  std::array<Transition, max_transitions> transitions{};
  std::size_t count = 0;
  const auto classify = [&](double activation, char& entered) {
    entered = activation >= 1.0 ? 1 : 0;
    if (activation <= 0.0 || activation >= 1.0) {
      return;
    }
    if (count < transitions.size()) {
      transitions[count] = {&entered, activation};
    }
    ++count;
  };
  for (std::size_t j = 0; j < entered_.limits.size(); ++j) {
    classify(limit_activation[static_cast<Eigen::Index>(j)], entered_.limits[j]);
  }
  for (std::size_t i = 0; i < stack.tasks.size(); ++i) {
    classify(stack.tasks[i].activation, entered_.tasks[i]);
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
      *transitions[k].entered = in ? 1 : 0;
      weight *= in ? transitions[k].activation : 1.0 - transitions[k].activation;
    }
    present_.assign_present(stack, entered_);
    law.solve(stack, present_, part_);
    solution.add(weight, part_);
  }
}

}  // namespace tope
