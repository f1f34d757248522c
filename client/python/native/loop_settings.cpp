#include <pybind11/stl.h>

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/text/numbers.hpp"
#include "python/native/bindings.hpp"
#include "python/native/closed_loop.hpp"
#include "python/native/facts_check.hpp"
#include "python/native/fields.hpp"
#include "python/native/law_choice.hpp"
#include "python/native/scenes.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/netem/trace.hpp"

namespace forcebound::python {
namespace {

/// What can be asked of a loop, with its parts in Python.
struct Asked {
  sim::ClosedLoop::Settings settings;
  PythonLoop::Parts parts{};
  std::string memory = "capped";
  std::map<std::string, double> parameters{};
  std::string recording{};
  std::string hostile{};
};

double share_from(py::handle value, const char* name) {
  const double share = number_from(value, name);
  if (share >= 0 && share <= 1) return share;
  throw py::value_error(std::string(name) + " must be 0 to 1, got " + text::to_text(share));
}

std::vector<Setting<Asked>> settings_there_are() {
  using Loop = sim::ClosedLoop::Settings;
  const auto loop = [](const char* name, auto member) {
    return setting<Asked>(name, [member](Asked& a) { return &(a.settings.*member); });
  };
  return {
      {"scene",
       [](Asked& a, py::handle value, const char*) { a.settings.scene = value.cast<const SceneHandle&>().scene; }},
      loop("device", &Loop::device),
      loop("hand", &Loop::hand),
      loop("law", &Loop::law),
      setting<Asked>("memory", [](Asked& a) { return &a.memory; }),
      setting<Asked>("parameters", [](Asked& a) { return &a.parameters; }),
      {"own_law",
       [](Asked& a, py::handle value, const char*) {
         a.parts.own_law = std::make_shared<OwnLaw::Shared>();
         a.parts.own_law->object = py::reinterpret_borrow<py::object>(value);
       }},
      {"own_environment",
       [](Asked& a, py::handle value, const char*) {
         a.parts.own_environment = std::make_shared<OwnEnvironment::Shared>();
         a.parts.own_environment->function = py::reinterpret_borrow<py::object>(value);
       }},
      {"own_hand", [](Asked& a, py::handle value, const char*) { a.parts.own_hand = own_hand_from(value); }},
      setting<Asked>("hostile_environment", [](Asked& a) { return &a.hostile; }),
      {"up", [](Asked& a, py::handle value,
                const char*) { a.settings.network.up = netem::parse_netem(value.cast<std::string>()); }},
      {"down", [](Asked& a, py::handle value,
                  const char*) { a.settings.network.down = netem::parse_netem(value.cast<std::string>()); }},
      {"trace", [](Asked& a, py::handle value,
                   const char*) { a.settings.network.trace = netem::load_trace(value.cast<std::string>()); }},
      loop("renders_locally", &Loop::renders_locally),
      {"seed", [](Asked& a, py::handle value,
                  const char*) { a.settings.seed = a.settings.network.seed = value.cast<std::uint64_t>(); }},
      {"settle_s",
       [](Asked& a, py::handle value, const char* name) { a.settings.settle_s = seconds_from(value, name); }},
      setting<Asked>("hold_s", [](Asked& a) { return &a.settings.policy.hold; }),
      setting<Asked>("drop_s", [](Asked& a) { return &a.settings.policy.drop; }),
      {"late_share",
       [](Asked& a, py::handle value, const char* name) { a.settings.timing.late_share = share_from(value, name); }},
      setting<Asked>("late_s_max", [](Asked& a) { return &a.settings.timing.late_max; }),
      setting<Asked>("measured_timing", [](Asked& a) { return &a.settings.timing.measured; }),
      setting<Asked>("choosing_s_max", [](Asked& a) { return &a.settings.timing.choosing_max; }),
      {"told", [](Asked& a, py::handle value, const char*) { a.settings.told = value.cast<control::DeviceFacts>(); }},
      setting<Asked>("recording", [](Asked& a) { return &a.recording; }),
  };
}

std::unique_ptr<PythonLoop> make_loop(const py::kwargs& named) {
  Asked asked;
  set_fields(asked, named, settings_there_are(), "ClosedLoop");
  sim::ClosedLoop::Settings& settings = asked.settings;
  const control::DeviceFacts& facts = settings.device.facts;
  if (!settings.scene || facts.joints() == 0) throw py::type_error("ClosedLoop: expected a scene and a device");
  if (settings.told) expect_same_mechanism(*settings.told, facts);
  if (!settings.scene->accepts(static_cast<std::uint32_t>(facts.translations()))) {
    throw py::value_error("scene '" + settings.scene->facts().name + "' is for devices of " +
                          settings.scene->accepted_degrees_of_freedom() + " degrees of freedom, device '" + facts.name +
                          "' has " + std::to_string(facts.translations()));
  }
  if (asked.parts.own_law) {
    asked.parts.own_law->name = settings.law;
    auto laws = std::make_shared<control::LawRegistry>(law_plugin::known_laws());
    add_own_law(*laws, asked.parts.own_law);
    settings.laws = std::move(laws);
  } else {
    settings.law = law_plugin::law_named(settings.law);
    settings.law_options = law_options(asked.memory, asked.parameters);
    if (settings.renders_locally && law_plugin::known_laws().find(settings.law).make_server_side) {
      throw py::value_error("rendering 'local': all forces go through the server-side law of '" + settings.law +
                            "'; accepted is 'remote'");
    }
  }
  if (asked.parts.own_environment) {
    settings.own_environment = own_environment("a function in Python", asked.parts.own_environment);
  }
  if (asked.parts.own_hand) {
    settings.make_hand = [hand = asked.parts.own_hand, dof = facts.translations()] {
      return std::make_unique<OwnHand>(hand, dof);
    };
  }
  if (!asked.hostile.empty()) {
    settings.environment =
        sim::EnvironmentSetting{.name = asked.hostile, .seed = settings.seed, .force_N_max = facts.force_N_max};
  }
  return std::make_unique<PythonLoop>(std::move(settings), std::move(asked.parts), asked.recording);
}

}  // namespace

void bind_closed_loop(py::module_& module) {
  py::class_<PythonLoop>(module, "ClosedLoop")
      .def(py::init(&make_loop))
      .def("run", &PythonLoop::run, py::arg("duration_s"))
      .def("take", &PythonLoop::take)
      .def("close", &PythonLoop::close)
      .def_property_readonly("time_s", &PythonLoop::time_s)
      .def_property_readonly("truth", &PythonLoop::truth);
  module.def("environment_names", &sim::environment_names);
  module.def("netem_help", &netem::netem_help);
}

}  // namespace forcebound::python
