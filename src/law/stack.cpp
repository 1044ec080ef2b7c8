#include <tope/law/stack.hpp>

#include <algorithm>

namespace tope {

Stack::Stack(int n, int inequalities)
    : motion(Matrix::Identity(n, n)),
      limit_activation(Vector::Zero(n)),
      limit_target(Vector::Zero(n)),
      motion_lower(Vector::Zero(n)),
      motion_upper(Vector::Zero(n)),
      headroom_lower(Vector::Ones(n)),
      headroom_upper(Vector::Ones(n)),
      inequality(Matrix::Zero(inequalities, n)),
      inequality_lower(Vector::Zero(inequalities)) {}

int Stack::max_level_rows() const {
  int largest = 0;
  int rows = 0;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    rows = (i > 0 && tasks[i].level == tasks[i - 1].level ? rows : 0) + static_cast<int>(tasks[i].b.size());
    largest = std::max(largest, rows);
  }
  return largest;
}

Selection::Selection(const Stack& stack)
    : limits(static_cast<std::size_t>(stack.size()), 0), tasks(stack.tasks.size(), 0) {}

void Selection::assign_present(const Stack& stack, const Selection& entered) {
  std::copy(entered.limits.begin(), entered.limits.end(), limits.begin());
  std::copy(entered.tasks.begin(), entered.tasks.end(), tasks.begin());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    for (int next = stack.tasks[i].replaced_by; next >= 0 && tasks[i] != 0;) {
      const auto replacement = static_cast<std::size_t>(next);
      tasks[i] = entered.tasks[replacement] != 0 ? 0 : 1;
      next = stack.tasks[replacement].replaced_by;
    }
  }
}

void Solution::set_zero() {
  begin();
  y.setZero();
  y_limits.setZero();
  laws = 0;
}

void Solution::begin() {
  singular = false;
  cut_off = false;
  laws = 1;
}

void Solution::add(double weight, const Solution& other) {
  y += weight * other.y;
  y_limits += weight * other.y_limits;
  singular = singular || other.singular;
  cut_off = cut_off || other.cut_off;
  laws += other.laws;
}

}  // namespace tope
