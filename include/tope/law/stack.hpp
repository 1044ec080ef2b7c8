#pragma once

#include <tope/common/types.hpp>

#include <vector>

namespace tope {

/// The rows of one task in whitened coordinates: A y = b.
struct TaskRows {
  int level = 1;            ///< 1 is the highest below the limits
  double activation = 1.0;  ///< 0 absent, 1 complete, between while the task is inserted or removed
  Matrix a;                 ///< A = Q L (m x n)
  Vector b;                 ///< (m)
  bool is_motion = false;   ///< A is the stack's motion T, whatever `a` holds: rows on the joints themselves
  int replaced_by = -1;  ///< index of the task that takes its place: absent wherever that one is in; -1: none
};

/// Everything a law sees at one instant: n unknowns y, limits on the motion T y (joint velocities or
/// accelerations), other rows with a lower bound, and tasks in order of level. No robot in here.
struct Stack {
  explicit Stack(int n, int inequalities = 0);

  int size() const { return static_cast<int>(motion.rows()); }

  Matrix motion;             ///< T (n x n): y to the bounded motion, one row a joint
  bool motion_is_y = false;  ///< T is the identity
  Vector limit_activation;   ///< xi (n), of the limit row of each joint
  Vector limit_target;       ///< motion asked for by the limit row where it is active (n)
  Vector motion_lower;       ///< bounds of the motion (n), for the unilateral law
  Vector motion_upper;
  Vector headroom_lower;  ///< multiples of the unilateral law's headroom that the bounds take (n)
  Vector headroom_upper;
  /// Limits on anything but the joints, for the unilateral law: C y >= lower, C (p x n), lower (p).
  Matrix inequality;
  Vector inequality_lower;
  std::vector<TaskRows> tasks;  ///< sorted by level

  /// Largest number of rows that one level can have.
  int max_level_rows() const;
};

/// Which limit rows and tasks take part: one element S of the family that the blends run over.
struct Selection {
  explicit Selection(const Stack& stack);

  std::vector<char> limits;  ///< one a joint
  std::vector<char> tasks;   ///< one a task

  /// Becomes `entered` without the tasks whose replacement has entered too.
  void assign_present(const Stack& stack, const Selection& entered);
};

/// What a law returns.
struct Solution {
  explicit Solution(int n) : y(Vector::Zero(n)), y_limits(Vector::Zero(n)) {}

  Vector y;               ///< whitened command (n)
  Vector y_limits;        ///< its part that serves the limits alone (n)
  bool singular = false;  ///< a task direction was damped
  bool cut_off = false;   ///< an iteration or size bound was reached; limits hold, tasks are served less well
  int laws = 0;           ///< laws evaluated

  void set_zero();
  /// Of one law that tells its y and y_limits later.
  void begin();
  /// Adds weight times another solution; flags and counts accumulate.
  void add(double weight, const Solution& other);
};

}  // namespace tope
