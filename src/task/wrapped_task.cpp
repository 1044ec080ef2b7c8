#include <tope/task/wrapped_task.hpp>

#include <utility>

namespace tope {

WrappedTask::WrappedTask(int size, std::unique_ptr<Task> task)
    : Task(size, static_cast<int>(task->jacobian().cols()), task->reference()), task_(std::move(task)) {}

WrappedTask::WrappedTask(const WrappedTask& other) : Task(other), task_(other.task_->clone()) {}

std::unique_ptr<Task> WrappedTask::aimed_at(const Target<PointTarget>& point,
                                            const Target<RotationTarget>& rotation) const {
  std::unique_ptr<Task> copy = clone();
  static_cast<WrappedTask&>(*copy).task_ = task_->aimed_at(point, rotation);
  return copy;
}

}  // namespace tope
