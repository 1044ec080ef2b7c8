#include "bindings.hpp"

#include <tope/common/error.hpp>

namespace nb = nanobind;

NB_MODULE(_core, module) {
  module.doc() = "C++ core of tope";
  static const nb::exception<tope::Error> error(module, "Error", PyExc_RuntimeError);
  static const nb::exception<tope::ConfigError> config_error(module, "ConfigError", error.ptr());
  tope::python::bind_robot(module);
  tope::python::bind_tasks(module);
  tope::python::bind_controller(module);
  tope::python::bind_simulation(module);
  tope::python::bind_live(module);
}
