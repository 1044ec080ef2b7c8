#pragma once

#include <tope/robot/robot.hpp>
#include <tope/task/task.hpp>

#include <functional>
#include <memory>

namespace tope::python {

/// A task that does not know its robot yet: the controller it is added to supplies it.
struct TaskSpec {
  std::string type;
  std::function<std::unique_ptr<Task>(const Robot&)> make;
};

}  // namespace tope::python
