#pragma once

#include <pybind11/pybind11.h>

/// The parts of the extension module `forcebound._native`, in the order in which they are added.
namespace forcebound::python {

void bind_facts(pybind11::module_& module);
void bind_devices(pybind11::module_& module);
void bind_scenes(pybind11::module_& module);
void bind_laws(pybind11::module_& module);
void bind_server_side_laws(pybind11::module_& module);
void bind_own_laws(pybind11::module_& module);
void bind_leader(pybind11::module_& module);
void bind_recordings(pybind11::module_& module);
void bind_closed_loop(pybind11::module_& module);
void bind_client(pybind11::module_& module);
void bind_server(pybind11::module_& module);

}  // namespace forcebound::python
