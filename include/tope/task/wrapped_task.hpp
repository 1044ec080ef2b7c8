#pragma once

#include <tope/task/task.hpp>

#include <memory>

namespace tope {

/// A task made of another: of its type and unit ("mixed" stays "mixed"), pursued by its reference, aimed at its goal. What
/// differs, a wrapper says in evaluate().
class WrappedTask : public Task {
 public:
  WrappedTask& operator=(const WrappedTask&) = delete;

  std::string_view type() const override { return task_->type(); }
  std::string_view error_unit() const override { return task_->error_unit(); }
  bool is_goal() const override { return task_->is_goal(); }
  std::optional<FrameGoal> frame_goal(double t) const override { return task_->frame_goal(t); }
  std::unique_ptr<Task> aimed_at(const Target<PointTarget>& point,
                                 const Target<RotationTarget>& rotation) const final;

 protected:
  WrappedTask(int size, std::unique_ptr<Task> task);
  WrappedTask(const WrappedTask& other);

  std::unique_ptr<Task> task_;
};

}  // namespace tope
