#pragma once

#include "support/random.hpp"

#include <tope/law/stack.hpp>

namespace tope::test {

struct RandomStackOptions {
  int n = 8;
  int levels = 3;
  int limit_transitions = 0;  ///< limit rows with an activation strictly between 0 and 1
  int task_transitions = 0;
  double complete_limits = 0.2;  ///< share of the other limit rows that are active
  double deficient = 0.3;  ///< share of tasks of deficient rank, and of tasks that repeat rows of others
  double weak = 0.0;       ///< share of tasks with singular values down to nearly zero
  bool beyond = false;     ///< some motion bounds exclude zero
  int inequalities = 0;    ///< other rows with a lower bound, a third of them violated at zero
};

/// A stack of random tasks; several may share a level. Sizes of the problem stay near one.
Stack random_stack(Random& random, const RandomStackOptions& options);

/// Everything that is fully active, and nothing else.
Selection select_complete(const Stack& stack);
/// Every limit row that is fully active, and every task.
Selection select_all_tasks(const Stack& stack);
/// The stack without the tasks below `level`.
Stack truncated(const Stack& stack, int level);
/// Rows of the selected tasks of one level, one above the other.
Matrix level_matrix(const Stack& stack, const Selection& selection, int level);
Vector level_target(const Stack& stack, const Selection& selection, int level);

}  // namespace tope::test
