#include <pybind11/stl.h>

#include <stdexcept>
#include <utility>

#include "forcebound/baselines/baselines.hpp"
#include "python/native/bindings.hpp"
#include "python/native/law_choice.hpp"
#include "python/native/running_law.hpp"

namespace forcebound::python {
namespace {

py::dict in_words(const control::LawParameter& parameter) {
  py::dict words;
  words["name"] = parameter.name;
  words["purpose"] = parameter.purpose;
  words["accepted"] = parameter.accepted();
  return words;
}

py::dict description_of(const std::string& name) {
  const control::LawRegistry laws = baselines::shipped_laws();
  const control::LawDescription& law = laws.find(name);
  py::list parameters;
  for (const control::LawParameter& parameter : law.parameters) parameters.append(in_words(parameter));
  py::dict words;
  words["name"] = law.name;
  words["summary"] = law.summary;
  words["reference"] = law.reference;
  words["guarantee"] = laws.guarantee(name);
  words["help"] = laws.help(name);
  words["shortens"] = law.shortens;
  words["has_server_side"] = static_cast<bool>(law.make_server_side);
  words["parameters"] = parameters;
  return words;
}

using Parameters = std::map<std::string, double>;

std::unique_ptr<RunningLaw> make_law(control::DeviceFacts facts, const std::string& name, const std::string& memory,
                                     const Parameters& parameters) {
  return std::make_unique<RunningLaw>(std::move(facts), name, law_options(memory, parameters));
}

}  // namespace

control::LawOptions law_options(const std::string& memory, const Parameters& parameters) {
  control::LawOptions options{.parameters = {parameters.begin(), parameters.end()}};
  if (memory != "capped" && memory != "full") {
    throw std::invalid_argument("memory must be 'capped' or 'full', got '" + memory + "'");
  }
  options.memory = memory == "full" ? control::EnergyMemory::full : control::EnergyMemory::capped;
  return options;
}

void bind_laws(py::module_& module) {
  module.def("law_names", [] { return baselines::shipped_laws().names(); });
  module.def("law_description", &description_of, py::arg("name"));

  py::class_<RunningLaw> law(module, "RunningLaw");
  law.def(py::init(&make_law), py::arg("facts"), py::arg("name"), py::arg("memory"), py::arg("parameters"));
  law.def(
      "step",
      [](RunningLaw& self, const py::object& position, const py::object& request_N, const py::object& interval_s,
         const py::object& joint, const py::object& jacobian, const py::object& latency_s,
         const py::object& latency_s_max, const py::object& effect_s, const py::object& held_s, bool write_failed) {
        return self.step(position, request_N,
                         {interval_s, joint, jacobian, latency_s, latency_s_max, effect_s, held_s, write_failed});
      },
      py::arg("position"), py::arg("request_N"), py::arg("interval_s") = py::none(), py::arg("joint") = py::none(),
      py::arg("jacobian") = py::none(), py::arg("latency_s") = py::none(), py::arg("latency_s_max") = py::none(),
      py::arg("effect_s") = py::none(), py::arg("held_s") = py::none(), py::arg("write_failed") = false);
  law.def(
      "run",
      [](RunningLaw& self, const py::object& positions, const py::object& requests_N, const py::object& intervals_s,
         const py::object& joints, const py::object& jacobians, const py::object& latencies_s) {
        return self.run(positions, requests_N, {intervals_s, joints, jacobians, latencies_s});
      },
      py::arg("positions"), py::arg("requests_N"), py::arg("intervals_s") = py::none(), py::arg("joints") = py::none(),
      py::arg("jacobians") = py::none(), py::arg("latencies_s") = py::none());
  law.def("confirm", &RunningLaw::confirm, py::arg("force_N"), py::arg("latency_s"));
  law.def("hear", &RunningLaw::receive, py::arg("numbers"));
  law.def("outgoing", &RunningLaw::outgoing);
  law.def("begin_server_side", &RunningLaw::begin_server_side);
  law.def_property_readonly("facts", &RunningLaw::facts);
  law.def_property_readonly("energy_J", &RunningLaw::energy_J);
  law.def_property_readonly("xi", &RunningLaw::xi);
  law.def_property_readonly("counts", &RunningLaw::counts);
  law.def_property_readonly("memory", [](const RunningLaw& self) {
    return self.options().memory == control::EnergyMemory::full ? "full" : "capped";
  });
  law.def_property_readonly("parameters", [](const RunningLaw& self) {
    return Parameters(self.options().parameters.begin(), self.options().parameters.end());
  });
}

}  // namespace forcebound::python
