#pragma once

#include <tope/common/types.hpp>
#include <tope/controller/options.hpp>
#include <tope/controller/status.hpp>
#include <tope/law/law.hpp>
#include <tope/law/whitening.hpp>
#include <tope/limit/conditions.hpp>
#include <tope/robot/robot_terms.hpp>
#include <tope/task/task.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tope {

/// Names a task inside the controller that returned it.
struct TaskHandle {
  int id = -1;
};

/// How a task enters, leaves or changes.
struct TransitionOptions {
  double over = 0.0;  ///< seconds from the next update; 0: at once
};

/// Turns the robot's state into a command that serves tasks in strict order of priority, keeps joint limits
/// and bounds.
///
/// Tasks come, go, move between levels and are replaced at once or over a stated time, several of them together, and
/// again while a change is under way: the chain blends the commands, and both ends are exact.
/// Building and changing tasks allocates and throws; update() does neither. One controller per thread.
class Controller {
 public:
  /// Takes a copy of the robot with its bounds as they are. Errors: ConfigError for bad options, or a safety
  /// inequality that fails (unless options.limits.enforce_conditions is false).
  Controller(const Robot& robot, const ControllerOptions& options);

  /// Adds a copy of the task at a level >= 1; a lower number is a higher priority, equal numbers share a
  /// level.
  TaskHandle add(int level, const Task& task, const TransitionOptions& options = {});
  /// Lets the task fade out. Errors: Error for an unknown handle.
  void remove(TaskHandle handle, const TransitionOptions& options = {});
  /// Moves the task to another level; it is complete all the while, at one level or the other, and its reference goes
  /// on. Errors: ConfigError for a bad level or time, Error for an unknown handle or a task that is leaving.
  void move(TaskHandle handle, int level, const TransitionOptions& options = {});
  /// Puts a copy of another task in its place, with another target for example. The handle then names that one, whose
  /// reference starts with the next update. Errors: as add() and move().
  void replace(TaskHandle handle, const Task& task, const TransitionOptions& options = {});

  /// Moves the limits of a joint from the next update on, towards an obstacle that moves for example; call it before
  /// every update while they move. Never allocates or throws. False, and nothing changes, for a joint that is none,
  /// a rate that is not finite, or limits too near each other. A potential field stays where it was built.
  [[nodiscard]] bool move_limits(int joint, const LimitMotion& motion) noexcept {
    return limits_.move(joint, motion);
  }

  /// Moves an obstacle, CollisionLimits::body_index(), from the next update on; call it before every update while it
  /// moves. Never allocates or throws. False, and nothing changes, without collisions, for a body that a link carries, or
  /// for a bad motion.
  [[nodiscard]] bool move_obstacle(int body, const BodyMotion& motion) noexcept {
    return collisions_ && collisions_->move(body, motion);
  }

  /// One cycle at state q (nq), v (nv) and time t [s]: writes the command u (nv). Never allocates, throws,
  /// locks, prints or reads a clock. Bad input: u = 0, Event::bad_input, nothing changed inside.
  const Status& update(const VectorArg& q, const VectorArg& v, double t, Eigen::Ref<Vector> u) noexcept;

  const Status& status() const { return status_; }
  /// How active each joint's upper and lower limit is, 0 to 1 (n).
  const Vector& upper_activation() const { return upper_activation_; }
  const Vector& lower_activation() const { return lower_activation_; }
  /// The task as of the last update (options.midpoint: in the middle of the period after it). Errors: Error for an unknown handle.
  const Task& task(TaskHandle handle) const;
  /// How far a task is present, 0 to 1; while it moves or is replaced, how far that has got.
  double activation(TaskHandle handle) const;

  const Robot& robot() const { return robot_; }
  const ControllerOptions& options() const { return options_; }
  const JointLimits& limits() const { return limits_; }
  /// The distances kept, as of the last update; null without any.
  const CollisionLimits* collisions() const { return collisions_ ? &*collisions_ : nullptr; }
  /// As describe(), for the last update.
  std::string status_text() const;
  /// The sampled-time inequalities of this robot, method and period.
  std::vector<Condition> conditions() const;

 private:
  struct Entry {
    int id;          // shared by a task and what it replaces
    int generation;  // grows with every replacement
    int level;
    std::unique_ptr<Task> task;
    double activation = 0.0;
    double from = 0.0;        // activation when the transition began
    double to = 0.0;          // and when it ends
    double over = 0.0;        // seconds it takes
    double start_time = 0.0;  // NaN until the next update
    void advance(double t);
    bool gone() const { return activation == 0.0 && to == 0.0; }
    void fade(double goal, double seconds);
    void drop() { activation = from = to = 0.0; }
  };

  const Entry& entry(TaskHandle handle) const;
  const Entry& staying(TaskHandle handle) const;
  std::unique_ptr<Task> fresh_copy(const Task& task) const;
  void insert(Entry entry, const TransitionOptions& options);
  int replacement_row(const Entry& entry) const;
  bool replaced(std::size_t row) const;
  void advance_tasks(double t);
  Unilateral::Options unilateral_options() const;
  LawOptions law_options() const;
  void choose_headroom();
  double headroom_factor(double place) const;
  void rebuild();
  bool valid(const VectorArg& q, const VectorArg& v, double t, const Eigen::Ref<Vector>& u) const;
  bool torque_mode() const { return options_.mode == Mode::torque; }
  void stand_still(Eigen::Ref<Vector> u) const;
  void evaluate_dynamics(const VectorArg& q, const VectorArg& v);
  void fill_limits(const VectorArg& q, const VectorArg& v);
  void fill_collisions(CollisionLimits& collisions);
  void fill_tasks(double t);
  void observe_tasks();
  void fill_field();
  void leave_bias_to_tasks();
  void to_motion(const Vector& y, Vector& motion) const;
  CommandBounds bound_velocity();
  CommandBounds bound_torque(const VectorArg& q);
  void report(const CommandBounds& bounds);
  void report_collisions(const CollisionLimits& collisions);

  Robot robot_;
  ControllerOptions options_;
  RobotTerms terms_;
  Vector authority_;      // what each drive can brake with, torque mode (n)
  double heaviest_;       // inertia of a joint, torque mode [kg or kg m2]
  Vector headroom_;       // of each joint at its limits (n)
  Vector free_headroom_;  // where its bounds are wide (n)
  double headroom_unit_;  // the law's, of which the stack holds multiples
  JointLimits limits_;
  std::optional<CollisionLimits> collisions_;
  double full_speed_drift_;  // of the distances, velocity mode [m/s2]
  std::optional<PotentialField> field_;
  Whitening whitening_;
  std::vector<Entry> entries_;  // sorted by level
  int next_id_ = 0;

  Stack stack_;
  std::size_t field_row_ = 0;           // index of the field's rows in the stack
  std::vector<std::size_t> entry_row_;  // index of each entry's rows in the stack
  Law law_;
  Solution solution_;
  Vector command_;
  Vector limit_command_;
  Vector command_lower_;
  Vector command_upper_;
  TorqueBounds torque_bounds_;
  Vector middle_q_;  // expected in the middle of the period, torque mode
  Vector middle_v_;
  Vector motion_;        // velocity or acceleration that the last command asked for
  Vector limit_motion_;  // its part that serves the limits alone
  Vector bias_y_;        // L^-1 h
  Vector upper_activation_;
  Vector lower_activation_;
  Status status_;
};

}  // namespace tope
