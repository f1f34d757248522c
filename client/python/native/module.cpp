#include <pybind11/pybind11.h>

#include <exception>

#include "forcebound/config/config_error.hpp"
#include "python/native/bindings.hpp"

PYBIND11_MODULE(_native, module) {
  namespace fb = forcebound::python;
  module.doc() = "The C++ behind the package forcebound. Use the package's modules.";
  module.attr("version") = FORCEBOUND_VERSION;
  // A file or text that is refused: line, place, what is wrong and what would be accepted.
  pybind11::register_exception_translator([](std::exception_ptr error) {  // NOLINT(performance-unnecessary-value-param)
    try {
      if (error) std::rethrow_exception(error);
    } catch (const forcebound::config::ConfigError& refused) {
      PyErr_SetString(PyExc_ValueError, refused.what());
    }
  });
  fb::bind_facts(module);
  fb::bind_devices(module);
  fb::bind_scenes(module);
  fb::bind_laws(module);
  fb::bind_server_side_laws(module);
  fb::bind_own_laws(module);
  fb::bind_leader(module);
  fb::bind_recordings(module);
  fb::bind_closed_loop(module);
  fb::bind_client(module);
  fb::bind_server(module);
}
