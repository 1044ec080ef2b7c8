#pragma once

#include "bindings.hpp"

#include <tope/common/error.hpp>
#include <tope/common/types.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <string>

namespace tope::python {

/// Anything that numpy makes an array of numbers from, a list for example. Errors: ConfigError, beginning with `what`.
template <typename T>
T numbers_from(const nanobind::handle& values, const std::string& what, const std::string& expected) {
  const nanobind::object array =
      nanobind::module_::import_("numpy").attr("asarray")(values, nanobind::arg("dtype") = "float64");
  T result;
  if (!nanobind::try_cast<T>(array, result)) {
    throw ConfigError(what + ": expected " + expected);
  }
  return result;
}

inline Vector3 three_numbers(const nanobind::handle& values, const std::string& what) {
  return numbers_from<Vector3>(values, what, "three numbers");
}

inline nanobind::tuple unit_quaternion() { return nanobind::make_tuple(1.0, 0.0, 0.0, 0.0); }

/// A 3 x 3 matrix, or a quaternion w, x, y, z.
inline Matrix3 rotation_from(const nanobind::handle& values, const std::string& what) {
  const nanobind::object numbers =
      nanobind::module_::import_("numpy").attr("asarray")(values, nanobind::arg("dtype") = "float64");
  Matrix3 matrix;
  if (nanobind::try_cast<Matrix3>(numbers, matrix)) {
    return matrix;
  }
  const auto wxyz =
      numbers_from<Eigen::Vector4d>(numbers, what, "a 3 x 3 rotation matrix or a quaternion (w, x, y, z)");
  if (std::abs(wxyz.norm() - 1.0) > 1e-2) {
    throw ConfigError(what + ": not a rotation: the norm of the quaternion is " +
                      std::to_string(wxyz.norm()));
  }
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized().toRotationMatrix();
}

}  // namespace tope::python
