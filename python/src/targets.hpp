#pragma once

#include "bindings.hpp"
#include "numbers.hpp"

#include <tope/reference/target.hpp>

namespace tope::python {

/// A point, a path, a stream, or a function of time that returns a point and its velocity.
Target<PointTarget> point_from(const nanobind::object& target);
/// A rotation, a path, a stream, or a function of time that returns a rotation and its angular velocity.
Target<RotationTarget> rotating_from(const nanobind::object& target);

}  // namespace tope::python
