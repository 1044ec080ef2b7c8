#pragma once

#include <nanobind/eigen/dense.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

namespace tope::python {

void bind_robot(nanobind::module_& module);
void bind_targets(nanobind::module_& module);
void bind_tasks(nanobind::module_& module);
void bind_collisions(nanobind::module_& module);
void bind_controller(nanobind::module_& module);
void bind_simulation(nanobind::module_& module);
void bind_live(nanobind::module_& module);

}  // namespace tope::python
