#include "bindings.hpp"

#include <tope/common/error.hpp>

#include <string_view>

namespace nb = nanobind;

namespace {

/// Errors quote files, and those may hold what is no text.
void raise(nb::handle type, std::string_view message) {
  const auto text = nb::steal(
      PyUnicode_DecodeUTF8(message.data(), static_cast<Py_ssize_t>(message.size()), "backslashreplace"));
  PyErr_SetObject(type.ptr(), text.ptr());
}

}  // namespace

NB_MODULE(_core, module) {
  module.doc() = "C++ core of tope";
  // A controller may hold a function, a moving target, that sees the controller: such a cycle lives until the program
  // ends, and nanobind would print about it then.
  nb::set_leak_warnings(false);
  static const nb::exception<tope::Error> error(module, "Error", PyExc_RuntimeError);
  static const nb::exception<tope::ConfigError> config_error(module, "ConfigError", error.ptr());
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const tope::ConfigError& e) {
      raise(config_error, e.what());
    } catch (const tope::Error& e) {
      raise(error, e.what());
    }
  });
  tope::python::bind_robot(module);
  tope::python::bind_targets(module);
  tope::python::bind_tasks(module);
  tope::python::bind_collisions(module);
  tope::python::bind_controller(module);
  tope::python::bind_simulation(module);
  tope::python::bind_live(module);
}
