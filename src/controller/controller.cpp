#include "../common/require_positive.hpp"

#include <tope/common/error.hpp>
#include <tope/controller/controller.hpp>
#include <tope/law/command_bounds.hpp>
#include <tope/law/smooth_step.hpp>
#include <tope/robot/braking_authority.hpp>
#include <tope/robot/heaviest_joint.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tope {
namespace {

// A state beyond this is an error of what measures it; its square must not overflow on the way. [rad, m or per second]
constexpr double kLargest = 1e6;

Matrix command_weight(const Robot& robot, const std::vector<double>& joint_weights) {
  if (joint_weights.empty()) {
    return Matrix::Identity(robot.nv(), robot.nv());
  }
  if (static_cast<int>(joint_weights.size()) != robot.nv()) {
    throw ConfigError("joint_weights: expected " + std::to_string(robot.nv()) + " values, got " +
                      std::to_string(joint_weights.size()));
  }
  Vector inverse(robot.nv());
  for (int j = 0; j < robot.nv(); ++j) {
    const double weight = joint_weights[static_cast<std::size_t>(j)];
    if (!std::isfinite(weight) || weight <= 0.0) {
      throw ConfigError("joint_weights: " + robot.joint_names()[static_cast<std::size_t>(j)] +
                        ": must be positive, got " + std::to_string(weight));
    }
    inverse[j] = 1.0 / weight;
  }
  return inverse.asDiagonal();
}

void require_conditions(const std::vector<Condition>& conditions) {
  for (const Condition& condition : conditions) {
    if (!condition.holds()) {
      throw ConfigError("limits are not safe: " + condition.name +
                        (condition.joint.empty() ? "" : " (" + condition.joint + ")") + ": " +
                        condition.expression + " fails with " + std::to_string(condition.value) + " > " +
                        std::to_string(condition.bound) + "; " + condition.advice);
    }
  }
}

/// The methods that keep limits by rows with activations.
bool uses_limit_rows(LimitMethod method) {
  return method != LimitMethod::unilateral && method != LimitMethod::none;
}

void require_level(int level) {
  if (level < 1) {
    throw ConfigError("level: must be at least 1 (limits are above all levels), got " +
                      std::to_string(level));
  }
}

void require_transition(const TransitionOptions& options) {
  if (!std::isfinite(options.over) || options.over < 0.0) {
    throw ConfigError("over: must be zero or positive [s], got " + std::to_string(options.over));
  }
}

double require_period(double dt) {
  if (!std::isfinite(dt) || dt <= 0.0) {
    throw ConfigError("dt: must be positive and finite [s], got " + std::to_string(dt));
  }
  return dt;
}

/// The envelope of torque mode starts from the speed limit of each limited joint.
void require_speed_limits(const Robot& robot, const JointLimits& limits) {
  for (int j = 0; j < robot.nv(); ++j) {
    if (limits.limited(j) && !std::isfinite(robot.velocity_limit()[j])) {
      throw ConfigError(
          "velocity_limit: " + robot.joint_names()[static_cast<std::size_t>(j)] +
          " has position limits but no speed limit: torque mode cannot tell how hard it must brake; "
          "set one");
    }
  }
}

/// Gains that are left open become what the drives can brake with.
JointLimitOptions with_gain(const Robot& robot, const ControllerOptions& options, const Vector& authority) {
  JointLimitOptions rows = options.limits.rows;
  if (options.mode == Mode::torque && !rows.gain) {
    const JointLimits limits(robot, rows);
    require_speed_limits(robot, limits);
    for (int j = 0; j < robot.nv(); ++j) {
      rows.gains.emplace(robot.joint_names()[static_cast<std::size_t>(j)],
                         braking_gain(limits, options.limits.method, j, authority[j]));
    }
  }
  return rows;
}

/// The distances to keep, if any. Gains that are left open are those of the joints.
std::optional<CollisionLimits> make_collisions(const Robot& robot, const LimitOptions& options,
                                               const JointLimits& joints) {
  if (!options.collisions) {
    return std::nullopt;
  }
  if (options.method != LimitMethod::unilateral) {
    throw ConfigError("collisions: the limit method '" + to_string(options.method) +
                      "' keeps no distances; use 'unilateral'");
  }
  return CollisionLimits(robot, *options.collisions, joints.least_gain(), options.rows.servo_gain);
}

}  // namespace

Controller::Controller(const Robot& robot, const ControllerOptions& options)
    : robot_(robot),
      options_(options),
      terms_(robot_),
      authority_(torque_mode() ? braking_authority(robot_) : Vector()),
      heaviest_(torque_mode() ? heaviest_joint(robot_) : 0.0),
      headroom_(Vector::Zero(robot_.nv())),
      free_headroom_(Vector::Zero(robot_.nv())),
      headroom_unit_(unilateral_options().headroom),
      limits_(robot_, with_gain(robot_, options_, authority_)),
      collisions_(make_collisions(robot_, options_.limits, limits_)),
      full_speed_drift_(collisions_ && !torque_mode() ? tope::full_speed_drift(robot_, *collisions_) : 0.0),
      whitening_(torque_mode() ? Whitening::torque(robot_.nv())
                               : Whitening::velocity(command_weight(robot_, options_.joint_weights))),
      stack_(robot_.nv(), collisions_ ? collisions_->size() : 0),
      law_(stack_, law_options()),
      solution_(robot_.nv()),
      command_(Vector::Zero(robot_.nv())),
      limit_command_(Vector::Zero(robot_.nv())),
      command_lower_(-robot_.velocity_limit()),
      command_upper_(robot_.velocity_limit()),
      torque_bounds_(robot_, options_.wheel_distribution),
      middle_q_(Vector::Zero(robot_.nq())),
      middle_v_(Vector::Zero(robot_.nv())),
      motion_(Vector::Zero(robot_.nv())),
      limit_motion_(Vector::Zero(robot_.nv())),
      bias_y_(Vector::Zero(robot_.nv())),
      upper_activation_(Vector::Zero(robot_.nv())),
      lower_activation_(Vector::Zero(robot_.nv())) {
  require_period(options_.dt);
  if (torque_mode() && !options_.joint_weights.empty()) {
    throw ConfigError("joint_weights: torque mode weighs joints by the mass matrix; leave them out");
  }
  if (torque_mode()) {
    require_speed_limits(robot_, limits_);
  }
  if (options_.limits.method == LimitMethod::potential_field) {
    field_.emplace(robot_, options_.limits.potential_field);
  }
  choose_headroom();
  if (options_.limits.enforce_conditions) {
    require_conditions(conditions());
  }
  rebuild();
}

/// What is not given suits the joint: those with little room between their bounds take less.
void Controller::choose_headroom() {
  const UnilateralOptions& given = options_.limits.unilateral;
  const double at_limit = unilateral_options().headroom;
  const double away = given.free_headroom.value_or((torque_mode() ? 10.0 : 5.0) * at_limit);
  require_positive("unilateral: free_headroom", away);
  if (given.headroom && away < at_limit) {
    throw ConfigError("unilateral: free_headroom " + std::to_string(away) + " must be at least headroom " +
                      std::to_string(at_limit));
  }
  const double widest = headroom_factor(1.0);
  for (int j = 0; j < robot_.nv(); ++j) {
    const double suitable = suitable_headroom(limits_, j, torque_mode(), widest * away) / widest;
    const double free = given.free_headroom ? away : suitable;
    headroom_[j] = given.headroom ? at_limit : std::min(at_limit, free);
    free_headroom_[j] = std::max(free, headroom_[j]);
  }
}

/// What smoothing multiplies the headroom by, at a place in [0, 1] of its spread.
double Controller::headroom_factor(double place) const {
  const auto& smoothing = options_.limits.unilateral.smoothing;
  return smoothing ? smoothing->factor(place) : 1.0;
}

std::vector<Condition> Controller::conditions() const {
  const LimitMethod method = options_.limits.method;
  const Vector headroom = headroom_factor(1.0) * free_headroom_;
  std::vector<Condition> conditions =
      torque_mode() ? torque_conditions(robot_, limits_, method, headroom, options_.dt, authority_)
                    : velocity_conditions(robot_, limits_, method, headroom, options_.dt);
  if (collisions_) {
    const std::vector<Condition> more =
        torque_mode() ? torque_conditions(*collisions_, limits_, options_.dt)
                      : velocity_conditions(*collisions_, full_speed_drift_, options_.dt);
    conditions.insert(conditions.end(), more.begin(), more.end());
  }
  return conditions;
}

TaskHandle Controller::add(int level, const Task& task, const TransitionOptions& options) {
  require_level(level);
  require_transition(options);
  std::unique_ptr<Task> copy = fresh_copy(task);
  const TaskHandle handle{next_id_++};
  insert({.id = handle.id, .generation = 0, .level = level, .task = std::move(copy)}, options);
  return handle;
}

void Controller::remove(TaskHandle handle, const TransitionOptions& options) {
  require_transition(options);
  const int leaving = entry(handle).id;
  for (Entry& e : entries_) {
    if (e.id == leaving) {
      e.fade(0.0, options.over);
    }
  }
}

void Controller::move(TaskHandle handle, int level, const TransitionOptions& options) {
  require_level(level);
  require_transition(options);
  const Entry& old = staying(handle);
  insert({.id = old.id, .generation = old.generation + 1, .level = level, .task = old.task->clone()},
         options);
}

void Controller::replace(TaskHandle handle, const Task& task, const TransitionOptions& options) {
  require_transition(options);
  std::unique_ptr<Task> copy = fresh_copy(task);
  const Entry& old = staying(handle);
  insert({.id = old.id, .generation = old.generation + 1, .level = old.level, .task = std::move(copy)},
         options);
}

/// A copy whose reference starts with the next update.
std::unique_ptr<Task> Controller::fresh_copy(const Task& task) const {
  if (task.jacobian().cols() != robot_.nv()) {
    throw ConfigError("task " + std::string(task.type()) + " was made for a robot with " +
                      std::to_string(task.jacobian().cols()) + " degrees of freedom, this one has " +
                      std::to_string(robot_.nv()));
  }
  std::unique_ptr<Task> copy = task.clone();
  copy->restart();
  return copy;
}

/// Lets an entry appear, behind those of its level.
void Controller::insert(Entry entry, const TransitionOptions& options) {
  std::erase_if(entries_, [](const Entry& e) { return e.gone(); });
  entry.activation = options.over > 0.0 ? 0.0 : 1.0;
  entry.fade(1.0, options.over);
  const auto after = std::upper_bound(entries_.begin(), entries_.end(), entry.level,
                                      [](int value, const Entry& e) { return value < e.level; });
  entries_.insert(after, std::move(entry));
  rebuild();
}

/// The newest entry that a handle names.
const Controller::Entry& Controller::entry(TaskHandle handle) const {
  const Entry* newest = nullptr;
  for (const Entry& e : entries_) {
    if (e.id == handle.id && (newest == nullptr || e.generation > newest->generation)) {
      newest = &e;
    }
  }
  if (newest == nullptr) {
    throw Error("no task with handle " + std::to_string(handle.id) +
                ": it was never added, or is removed already");
  }
  return *newest;
}

const Controller::Entry& Controller::staying(TaskHandle handle) const {
  const Entry& found = entry(handle);
  if (found.to == 0.0) {
    throw Error("the task with handle " + std::to_string(handle.id) + " is being removed: add it anew");
  }
  return found;
}

const Task& Controller::task(TaskHandle handle) const { return *entry(handle).task; }

double Controller::activation(TaskHandle handle) const { return entry(handle).activation; }

Unilateral::Options Controller::unilateral_options() const {
  return options_.limits.unilateral.resolved(options_.mode, heaviest_);
}

LawOptions Controller::law_options() const {
  return {.method = options_.limits.method,
          .hierarchy = options_.singularities,
          .unilateral = unilateral_options(),
          .smoothing = options_.limits.unilateral.smoothing};
}

/// Lays out the stack for the present entries and reserves the law's memory.
void Controller::rebuild() {
  const int n = robot_.nv();
  stack_.motion = whitening_.motion();
  stack_.motion_is_y = whitening_.is_identity();
  stack_.tasks.clear();
  entry_row_.clear();
  // the field goes to the lowest level that leaves it some freedom: above a task that takes all of it
  bool field_pending = field_.has_value();
  const auto add_field = [&](int level) {
    field_row_ = stack_.tasks.size();
    stack_.tasks.push_back(
        {.level = level, .activation = 0.0, .a = Matrix(n, n), .b = Vector::Zero(n), .is_motion = true});
    field_pending = false;
  };
  int offset = 0;  // makes room for the field's level
  for (const Entry& e : entries_) {
    if (field_pending && e.task->size() >= n) {
      add_field(e.level);
      offset = 1;
    }
    entry_row_.push_back(stack_.tasks.size());
    stack_.tasks.push_back({.level = e.level + offset,
                            .activation = e.activation,
                            .a = Matrix::Zero(e.task->size(), n),
                            .b = Vector::Zero(e.task->size()),
                            .is_motion = e.task->is_motion()});
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    stack_.tasks[entry_row_[i]].replaced_by = replacement_row(entries_[i]);
  }
  if (field_pending) {
    add_field(entries_.empty() ? 1 : entries_.back().level + 1);
  }
  law_ = Law(stack_, law_options());
}

/// Index of the rows of what replaces an entry next; -1: nothing.
int Controller::replacement_row(const Entry& entry) const {
  int row = -1;
  int generation = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& other = entries_[i];
    if (other.id == entry.id && other.generation > entry.generation && other.generation < generation) {
      generation = other.generation;
      row = static_cast<int>(entry_row_[i]);
    }
  }
  return row;
}

bool Controller::valid(const VectorArg& q, const VectorArg& v, double t, const Eigen::Ref<Vector>& u) const {
  // written so that what is no number fails too
  return q.size() == robot_.nq() && v.size() == robot_.nv() && u.size() == robot_.nv() && std::isfinite(t) &&
         (q.array().abs() <= kLargest).all() && (v.array().abs() <= kLargest).all();
}

const Status& Controller::update(const VectorArg& q, const VectorArg& v, double t,
                                 Eigen::Ref<Vector> u) noexcept {
  status_ = Status{};
  if (!valid(q, v, t, u)) {
    status_.add(Event::bad_input);
    stand_still(u);
    return status_;
  }
  if (torque_mode()) {
    evaluate_dynamics(q, v);
    whitening_.set_mass_matrix(terms_.mass_matrix());
    stack_.motion = whitening_.motion();
  } else {
    terms_.update(q, v);
  }
  fill_limits(q, v);
  fill_tasks(t);
  fill_field();
  if (torque_mode() && options_.null_space == NullSpace::zero_torque) {
    leave_bias_to_tasks();
  }
  law_.solve(stack_, solution_);
  report(torque_mode() ? bound_torque(q) : bound_velocity());
  if (!command_.allFinite()) {  // a target said what is no number, or too large a one
    status_.add(Event::bad_input);
    motion_.setZero();  // the next cycle starts from it
    stand_still(u);
    return status_;
  }
  observe_tasks();
  u = command_;
  return status_;
}

/// No motion; in torque mode the bias of the last valid state and a torque against its velocity.
void Controller::stand_still(Eigen::Ref<Vector> u) const {
  if (!torque_mode() || u.size() != robot_.nv()) {
    u.setZero();
    return;
  }
  constexpr double damping = 4.0;  // [1/s]
  u = terms_.bias() - damping * terms_.mass_matrix().diagonal().cwiseProduct(terms_.velocity());
  u = u.cwiseMax(-robot_.effort_limit()).cwiseMin(robot_.effort_limit());
}

/// A torque acts for a whole period: with the terms of its middle, the acceleration on the way is on average what was asked
/// for, to second order in the period. A light wrist on a fast arm misses by several rad/s2 otherwise.
void Controller::evaluate_dynamics(const VectorArg& q, const VectorArg& v) {
  const double ahead = options_.midpoint ? 0.5 * options_.dt : 0.0;
  middle_q_ = q + ahead * v;
  middle_v_ = v + ahead * motion_;
  terms_.update_dynamics(middle_q_, middle_v_);
}

void Controller::fill_limits(const VectorArg& q, const VectorArg& v) {
  const bool by_rows = uses_limit_rows(options_.limits.method);
  const JointLimits::Part part = by_rows ? JointLimits::Part::rows : JointLimits::Part::bounds;
  if (torque_mode()) {
    limits_.update_second_order(q, v, part);
  } else {
    limits_.update(q, part);
  }
  if (by_rows) {
    stack_.limit_activation = limits_.activation();
    stack_.limit_target = limits_.target();
  } else {
    stack_.motion_lower = limits_.motion_lower();
    stack_.motion_upper = limits_.motion_upper();
    limits_.headroom(headroom_, free_headroom_, stack_.headroom_lower, stack_.headroom_upper);
    stack_.headroom_lower /= headroom_unit_;
    stack_.headroom_upper /= headroom_unit_;
  }
  if (collisions_) {
    fill_collisions(*collisions_);
  }
}

void Controller::fill_collisions(CollisionLimits& collisions) {
  if (torque_mode()) {
    collisions.update_second_order(terms_);
  } else {
    collisions.update(terms_);
  }
  whitening_.rows(collisions.jacobian(), stack_.inequality);
  stack_.inequality_lower = collisions.motion_lower();
}

/// From where it is, beginning with the next update.
void Controller::Entry::fade(double goal, double seconds) {
  from = activation;
  to = goal;
  over = seconds;
  start_time = std::numeric_limits<double>::quiet_NaN();
}

void Controller::Entry::advance(double t) {
  if (std::isnan(start_time)) {
    start_time = t;
  }
  const double progress = over > 0.0 ? (t - start_time) / over : 1.0;
  activation = from + (to - from) * smooth_step(progress);
}

void Controller::advance_tasks(double t) {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    entries_[i].advance(t);
    stack_.tasks[entry_row_[i]].activation = entries_[i].activation;
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (replaced(entry_row_[i])) {
      entries_[i].drop();
      stack_.tasks[entry_row_[i]].activation = 0.0;
    }
  }
}

/// True where what takes the place of a task is complete.
bool Controller::replaced(std::size_t row) const {
  int next = stack_.tasks[row].replaced_by;
  while (next >= 0 && stack_.tasks[static_cast<std::size_t>(next)].activation < 1.0) {
    next = stack_.tasks[static_cast<std::size_t>(next)].replaced_by;
  }
  return next >= 0;
}

void Controller::fill_tasks(double t) {
  advance_tasks(t);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry& e = entries_[i];
    TaskRows& rows = stack_.tasks[entry_row_[i]];
    if (e.gone()) {
      continue;
    }
    if (torque_mode()) {
      e.task->update_second_order(terms_, t, motion_);
      rows.b = e.task->acceleration();
    } else {
      e.task->update(terms_, t);
      rows.b = e.task->rate();
    }
    if (!rows.is_motion) {
      whitening_.rows(e.task->jacobian(), rows.a);
    }
    if (e.task->near_flip()) {
      status_.add(Event::near_flip);
    }
  }
}

/// Tasks that promise a time learn what became of their wish.
void Controller::observe_tasks() {
  for (Entry& e : entries_) {
    if (e.activation < 1.0 || !e.task->duration()) {
      continue;
    }
    e.task->observe(motion_);
    if (e.task->held()) {
      status_.add(Event::held);
    }
  }
}

void Controller::fill_field() {
  if (!field_) {
    return;
  }
  field_->update(terms_.position());
  TaskRows& rows = stack_.tasks[field_row_];
  rows.activation = field_->in_range() ? 1.0 : 0.0;
  rows.b = field_->motion();
  if (torque_mode()) {  // follow the field's speed
    rows.b = options_.limits.rows.servo_gain * (rows.b - terms_.velocity());
  }
  for (int joint = 0; joint < robot_.nv(); ++joint) {
    if (field_->repels(joint)) {
      stack_.limit_activation[joint] = 0.0;
    }
  }
}

/// The paper's null space (9): every row pays for the bias of the motion it asks for, and no more is compensated.
void Controller::leave_bias_to_tasks() {
  bias_y_.noalias() = stack_.motion.transpose() * terms_.bias();
  for (TaskRows& rows : stack_.tasks) {
    const Matrix& a = rows.is_motion ? stack_.motion : rows.a;
    rows.b.noalias() += a * bias_y_;
  }
  to_motion(bias_y_, limit_motion_);
  if (uses_limit_rows(options_.limits.method)) {
    stack_.limit_target += limit_motion_;
    return;
  }
  stack_.motion_lower += limit_motion_;
  stack_.motion_upper += limit_motion_;
  stack_.inequality_lower.noalias() += stack_.inequality * bias_y_;
}

void Controller::to_motion(const Vector& y, Vector& motion) const {
  if (stack_.motion_is_y) {
    motion = y;
  } else {
    motion.noalias() = stack_.motion * y;
  }
}

CommandBounds Controller::bound_velocity() {
  to_motion(solution_.y_limits, limit_command_);
  to_motion(solution_.y, command_);
  if (uses_limit_rows(options_.limits.method)) {
    limits_.blended_speed_bounds(stack_.limit_activation, command_lower_, command_upper_);
  }
  const CommandBounds bounds = CommandBounds::apply(command_lower_, command_upper_, limit_command_, command_);
  motion_ = command_;
  return bounds;
}

CommandBounds Controller::bound_torque(const VectorArg& q) {
  if (options_.null_space == NullSpace::zero_torque) {
    solution_.y -= bias_y_;
    solution_.y_limits -= bias_y_;
  }
  to_motion(solution_.y_limits, limit_motion_);
  to_motion(solution_.y, motion_);
  limit_command_ = terms_.bias();
  command_ = terms_.bias();
  limit_command_.noalias() += terms_.mass_matrix() * limit_motion_;
  command_.noalias() += terms_.mass_matrix() * motion_;
  if (uses_limit_rows(options_.limits.method)) {
    limits_.blended_acceleration_bounds(stack_.limit_activation, options_.dt,
                                        torque_bounds_.acceleration_lower(),
                                        torque_bounds_.acceleration_upper());
  }
  const auto& base = robot_.base();
  const double yaw = base ? q[base->options().joints[2]] : 0.0;
  return torque_bounds_.apply(terms_.mass_matrix(), yaw, limit_motion_, limit_command_, motion_, command_);
}

void Controller::report(const CommandBounds& bounds) {
  status_.scale = bounds.scale;
  status_.bound_joint = bounds.clipped >= 0 ? bounds.clipped : bounds.most_binding;
  if (bounds.scale < 1.0) {
    status_.add(Event::scaled);
  }
  if (bounds.clipped >= 0) {
    status_.add(Event::clipped);
  }
  switch (options_.limits.method) {
    case LimitMethod::unilateral:
      limits_.engagement(motion_, upper_activation_, lower_activation_);
      break;
    case LimitMethod::none:
      break;
    default:
      limits_.activation_by_side(upper_activation_, lower_activation_);
  }
  status_.laws = solution_.laws;
  Eigen::Index joint = 0;
  if (upper_activation_.cwiseMax(lower_activation_).maxCoeff(&joint) > 0.0) {
    status_.add(Event::limit);
    status_.limit_joint = static_cast<int>(joint);
  }
  status_.beyond_joint = limits_.beyond();
  if (status_.beyond_joint >= 0) {
    status_.add(Event::beyond);
  }
  if (collisions_) {
    report_collisions(*collisions_);
  }
  if (solution_.singular) {
    status_.add(Event::singular);
  }
  if (solution_.cut_off) {
    status_.add(Event::cut_off);
  }
}

void Controller::report_collisions(const CollisionLimits& collisions) {
  // level 0 alone would leave every row its whole headroom
  const double headroom = unilateral_options().inequality_headroom * headroom_factor(0.5);
  status_.avoiding_pair = collisions.pressed_by(motion_, headroom);
  if (status_.avoiding_pair >= 0) {
    status_.add(Event::avoiding);
  }
  status_.near_pair = collisions.inside();
  if (status_.near_pair >= 0) {
    status_.add(Event::too_near);
  }
}

std::string Controller::status_text() const {
  return collisions_ ? describe(status_, robot_, collisions_->names()) : describe(status_, robot_);
}

}  // namespace tope
