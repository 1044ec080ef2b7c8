#include "support/random_stack.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace tope::test {
namespace {

TaskRows random_task(Random& random, const RandomStackOptions& options, int level,
                     const std::vector<TaskRows>& above) {
  const int rows = random.integer(1, std::max(1, std::min(6, options.n / 2)));
  const int full = std::min(rows, options.n);
  const int rank = random.chance(options.deficient) ? random.integer(1, full) : full;
  const bool weak = random.chance(options.weak);
  const double low = weak ? 0.005 : 0.5;
  const double high = weak ? 0.2 : 2.0;
  TaskRows task{.level = level,
                .activation = 1.0,
                .a = random.matrix_of_rank(rows, options.n, rank, low, high),
                .b = random.vector(rows)};
  if (!above.empty() && random.chance(options.deficient)) {
    const TaskRows& other =
        above[static_cast<std::size_t>(random.integer(0, static_cast<int>(above.size()) - 1))];
    task.a.row(0) = random.uniform(0.5, 2.0) * other.a.row(0);
  }
  return task;
}

void set_limits(Random& random, const RandomStackOptions& options, Stack& stack) {
  int transitions = options.limit_transitions;
  std::vector<int> joints(static_cast<std::size_t>(options.n));
  for (int j = 0; j < options.n; ++j) {
    joints[static_cast<std::size_t>(j)] = j;
    std::swap(joints[static_cast<std::size_t>(random.integer(0, j))], joints[static_cast<std::size_t>(j)]);
  }
  for (const int j : joints) {
    if (transitions-- > 0) {
      stack.limit_activation[j] = random.uniform(0.01, 0.99);
    } else {
      stack.limit_activation[j] = random.chance(options.complete_limits) ? 1.0 : 0.0;
    }
    stack.limit_target[j] = random.normal();
    stack.motion_lower[j] = -random.uniform(0.05, 1.0);
    stack.motion_upper[j] = random.uniform(0.05, 1.0);
    stack.headroom_lower[j] = random.uniform(0.5, 2.5);
    stack.headroom_upper[j] = random.uniform(0.5, 2.5);
    if (options.beyond && random.chance(0.2)) {
      const double shift = random.chance(0.5) ? 1.5 : -1.5;
      stack.motion_lower[j] += shift;
      stack.motion_upper[j] += shift;
    }
  }
}

/// Rows that contradict each other and the joints' bounds are among them, and a row of zeros.
void set_inequalities(Random& random, Stack& stack) {
  for (Eigen::Index i = 0; i < stack.inequality_lower.size(); ++i) {
    stack.inequality.row(i) = random.vector(stack.size(), 1.0 / std::sqrt(stack.size())).transpose();
    stack.inequality_lower[i] = random.chance(0.3) ? random.uniform(0.0, 0.5) : -random.uniform(0.0, 0.5);
    if (i > 0 && random.chance(0.2)) {
      stack.inequality.row(i) = -random.uniform(0.5, 2.0) * stack.inequality.row(i - 1);
    }
    if (random.chance(0.1)) {
      stack.inequality.row(i).setZero();
    }
  }
}

}  // namespace

Stack random_stack(Random& random, const RandomStackOptions& options) {
  Stack stack(options.n, options.inequalities);
  set_inequalities(random, stack);
  if (random.chance(0.7)) {
    stack.motion = random.positive_definite(options.n, 0.3, 3.0).llt().matrixL();
  }
  set_limits(random, options, stack);
  for (int level = 1; level <= options.levels; ++level) {
    for (int i = random.chance(0.3) ? 2 : 1; i > 0; --i) {
      stack.tasks.push_back(random_task(random, options, level, stack.tasks));
    }
  }
  for (int i = 0; i < options.task_transitions; ++i) {
    const int last = static_cast<int>(stack.tasks.size()) - 1;
    stack.tasks[static_cast<std::size_t>(random.integer(0, last))].activation = random.uniform(0.01, 0.99);
  }
  return stack;
}

Selection select_complete(const Stack& stack) {
  Selection selection(stack);
  for (std::size_t j = 0; j < selection.limits.size(); ++j) {
    selection.limits[j] = stack.limit_activation[static_cast<Eigen::Index>(j)] >= 1.0 ? 1 : 0;
  }
  for (std::size_t i = 0; i < selection.tasks.size(); ++i) {
    selection.tasks[i] = stack.tasks[i].activation >= 1.0 ? 1 : 0;
  }
  return selection;
}

Selection select_all_tasks(const Stack& stack) {
  Selection selection = select_complete(stack);
  std::fill(selection.tasks.begin(), selection.tasks.end(), 1);
  return selection;
}

Stack truncated(const Stack& stack, int level) {
  Stack result = stack;
  std::erase_if(result.tasks, [level](const TaskRows& task) { return task.level > level; });
  return result;
}

Matrix level_matrix(const Stack& stack, const Selection& selection, int level) {
  Matrix rows(0, stack.size());
  for (std::size_t i = 0; i < stack.tasks.size(); ++i) {
    const TaskRows& task = stack.tasks[i];
    if (task.level == level && selection.tasks[i] != 0) {
      const Eigen::Index before = rows.rows();
      rows.conservativeResize(before + task.a.rows(), Eigen::NoChange);
      rows.bottomRows(task.a.rows()) = task.a;
    }
  }
  return rows;
}

Vector level_target(const Stack& stack, const Selection& selection, int level) {
  Vector target(0);
  for (std::size_t i = 0; i < stack.tasks.size(); ++i) {
    const TaskRows& task = stack.tasks[i];
    if (task.level == level && selection.tasks[i] != 0) {
      const Eigen::Index before = target.size();
      target.conservativeResize(before + task.b.size());
      target.tail(task.b.size()) = task.b;
    }
  }
  return target;
}

}  // namespace tope::test
