#pragma once

#include <tope/common/types.hpp>
#include <tope/reference/reference.hpp>
#include <tope/reference/target.hpp>
#include <tope/robot/robot_terms.hpp>

#include <memory>
#include <optional>
#include <string_view>

namespace tope {

/// Where a task wants a frame of the robot to be; what the task does not care about is missing.
struct FrameGoal {
  int frame = -1;  ///< index of the frame in the robot
  std::optional<Vector3> position{};
  std::optional<Matrix3> rotation{};
};

/// One goal: an error e(q) of m rows, its Jacobian, and the rate the error is to have. What the goal is,
/// apart from how a control law pursues it. A new task derives from this class and implements evaluate() and
/// clone().
class Task {
 public:
  virtual ~Task() = default;

  int size() const { return static_cast<int>(error_.size()); }
  virtual std::string_view type() const = 0;
  /// "m", "rad", empty for a pure number, or "mixed" where rows differ.
  virtual std::string_view error_unit() const = 0;
  /// False for tasks that only take up freedom that is left (posture, damping).
  virtual bool is_goal() const { return true; }
  /// True when J is the identity whatever the state: the rows are the joints themselves.
  virtual bool is_motion() const { return false; }
  /// Where the task wants its frame at time t [s]; none for a task that is not about a frame.
  virtual std::optional<FrameGoal> frame_goal(double /*t*/) const { return std::nullopt; }

  /// Evaluates the task at the robot's state and time t [s]. Never allocates or throws. The first call starts
  /// the reference.
  void update(const RobotTerms& terms, double t);
  /// The same for second order; `acceleration` (nv) is what the joints were last commanded to.
  void update_second_order(const RobotTerms& terms, double t, const Vector& acceleration);
  /// Tells the task which motion the joints were commanded to after all (nv): velocities, or accelerations of second
  /// order. Notes whether that holds the task back; on release, a reference that can plans anew.
  void observe(const Vector& motion);
  /// True while the task is off its plan and gets less than half of what it asks for: its promised time does not hold.
  bool held() const { return held_; }
  /// Lets the next update() start the reference anew.
  void restart();

  const Vector& error() const { return error_; }  ///< e (m)
  const Matrix& jacobian() const {
    return jacobian_;
  }  ///< J (m x nv): de/dt = J v - (what the target's motion adds)
  /// Right-hand side b of J v = b (m): the reference's rate of the error plus what the target's motion asks
  /// for (5).
  const Vector& rate() const { return rate_; }
  /// Right-hand side b of J dv/dt = b (m) after update_second_order(): the reference's acceleration less the
  /// drift, (7).
  const Vector& acceleration() const { return acceleration_; }
  /// de/dt (m) after update_second_order().
  const Vector& error_rate() const { return error_rate_; }
  /// d2e/dt2 (m) if no joint accelerated, after update_second_order().
  const Vector& drift() const { return drift_; }
  /// Seconds from start to promised arrival, if the reference promises one.
  std::optional<double> duration() const { return duration_; }
  const Reference& reference() const { return reference_; }
  /// Gain of the reference [1/s].
  double gain() const;
  /// True when a rotation error lies within 0.05 rad of pi, where its direction is about to flip.
  bool near_flip() const { return near_flip_; }

  virtual std::unique_ptr<Task> clone() const = 0;
  /// A copy with another target for its frame; a plain copy of a task that is not about a frame.
  virtual std::unique_ptr<Task> aimed_at(const Target<PointTarget>& /*point*/,
                                         const Target<RotationTarget>& /*rotation*/) const {
    return clone();
  }

 protected:
  Task(int size, int nv, Reference reference);
  Task(const Task&) = default;
  Task& operator=(const Task&) = default;

  /// Fills error_, jacobian_ and feedforward_.
  virtual void evaluate(const RobotTerms& terms, double t) = 0;
  /// Fills drift_, after evaluate() and error_rate_, which a task whose J leaves joints out mends. Tasks whose Jacobian
  /// and target stand still have no drift.
  virtual void evaluate_drift(const RobotTerms& /*terms*/, double /*t*/) {}
  /// For a task made of another: evaluates that one without its reference; then, if needed, its error_rate() and
  /// drift().
  static void evaluate_part(Task& part, const RobotTerms& terms, double t) { part.evaluate(terms, t); }
  static void evaluate_part_drift(Task& part, const RobotTerms& terms, double t) {
    part.find_drift(terms, t);
  }
  static const Vector& feedforward_of(const Task& part) { return part.feedforward_; }

  Vector error_;
  Matrix jacobian_;
  Vector feedforward_;  ///< rate of the error's target, so that de/dt = J v - feedforward
  Vector error_rate_;   ///< de/dt
  Vector drift_;        ///< d2e/dt2 if no joint accelerated
  bool near_flip_ = false;

 private:
  void find_drift(const RobotTerms& terms, double t);
  void start_reference(double t, const Vector& rate, const Vector& acceleration);
  bool replans() const;

  Vector rate_;
  Vector acceleration_;
  Vector served_;  // of rate_ or acceleration_, what the last motion gave
  Reference reference_;
  std::optional<double> duration_;  // of reference_, asked for in every cycle
  double last_time_ = 0.0;
  bool started_ = false;
  bool second_order_ = false;
  bool held_ = false;
  bool released_ = false;  // since the last update
};

}  // namespace tope
