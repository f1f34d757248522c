#include "python/native/scenes.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <string_view>

#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"
#include "python/native/bindings.hpp"

namespace forcebound::python {
namespace {

namespace py = pybind11;

/// Device and hand that touch something in the scene.
py::tuple suggested(const SceneHandle& handle) {
  server::SuggestedHand hand;
  {
    const py::gil_scoped_release others_run;
    hand = server::suggested_hand(handle.scene);
  }
  return py::make_tuple(hand.device, hand.hand);
}

}  // namespace

void bind_scenes(py::module_& module) {
  py::class_<SceneHandle>(module, "Scene", "What the server simulates: shapes, effects, fields, tissue and bodies.")
      .def_property_readonly("name", [](const SceneHandle& s) { return s.scene->facts().name; })
      .def_property_readonly("description", [](const SceneHandle& s) { return s.scene->facts().description; })
      .def_property_readonly(
          "degrees_of_freedom", [](const SceneHandle& s) { return s.scene->facts().degrees_of_freedom; },
          "Of the devices that it is for; 0: any.")
      .def_property_readonly(
          "simulated", [](const SceneHandle& s) { return server::summary(*s.scene); }, "What is simulated, in words.")
      .def_property_readonly("suggested", &suggested,
                             "Names of a device and a hand that touch something in it, as a tuple.")
      .def("__repr__", [](const SceneHandle& s) { return "Scene('" + s.scene->facts().name + "')"; });
  module.def(
      "load_scene", [](const std::string& name_or_file) { return SceneHandle{server::load_scene(name_or_file)}; },
      py::arg("name_or_file"), py::call_guard<py::gil_scoped_release>());
  module.def(
      "parse_scene",
      [](std::string_view toml_text, const std::string& place) {
        return SceneHandle{server::parse_scene(toml_text, place)};
      },
      py::arg("toml_text"), py::arg("place"), py::call_guard<py::gil_scoped_release>());
  module.def("scene_names", [] { return server::SceneLibrary::shipped().all_names(); });
}

}  // namespace forcebound::python
