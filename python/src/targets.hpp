#pragma once

#include "bindings.hpp"

#include <tope/common/error.hpp>
#include <tope/reference/target.hpp>

#include <string>

namespace tope::python {

/// Anything that numpy makes an array of numbers from, a list for example.
nanobind::object numbers_from(const nanobind::handle& values);

template <typename T>
T numbers_from(const nanobind::handle& values, const char* what, const char* expected) {
  T result;
  if (!nanobind::try_cast<T>(numbers_from(values), result)) {
    throw ConfigError(std::string(what) + ": expected " + expected);
  }
  return result;
}

/// A point, a path, a stream, or a function of time that returns a point and its velocity.
Target<PointTarget> point_from(const nanobind::object& target);
/// A rotation, a path, a stream, or a function of time that returns a rotation and its angular velocity.
Target<RotationTarget> rotating_from(const nanobind::object& target);

}  // namespace tope::python
