#pragma once

#include <tope/reference/exponential.hpp>
#include <tope/reference/predefined_time.hpp>

#include <variant>

namespace tope {

/// How a task's error is to vanish. A new reference is one class and one entry here.
using Reference = std::variant<Exponential, PredefinedTime>;

}  // namespace tope
