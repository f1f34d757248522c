#include <pybind11/stl.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/law_plugin/known_laws.hpp"
#include "python/native/bindings.hpp"
#include "python/native/fields.hpp"
#include "python/native/law_choice.hpp"
#include "python/native/live_client.hpp"

namespace forcebound::python {
namespace {

struct AskedClient {
  LiveClient::Settings settings;
  std::string memory = "capped";
  std::map<std::string, double> parameters{};
};

struct ClientSetting {
  const char* name;
  void (*set)(AskedClient&, py::handle value, const char* name);
};

std::vector<ClientSetting> client_settings() {
  using A = AskedClient;
  return {
      {"server", [](A& a, py::handle value, const char* name) { a.settings.client.server = text_from(value, name); }},
      {"device",
       [](A& a, py::handle value, const char*) { a.settings.device = value.cast<device::DeviceDescription>(); }},
      {"hand", [](A& a, py::handle value, const char* name) { a.settings.client.hand = text_from(value, name); }},
      {"law", [](A& a, py::handle value, const char* name) { a.settings.client.law = text_from(value, name); }},
      {"memory", [](A& a, py::handle value, const char* name) { a.memory = text_from(value, name); }},
      {"parameters",
       [](A& a, py::handle value, const char*) { a.parameters = value.cast<std::map<std::string, double>>(); }},
      {"scene", [](A& a, py::handle value, const char* name) { a.settings.client.scene = text_from(value, name); }},
      {"renders_locally",
       [](A& a, py::handle value, const char*) { a.settings.client.renders_locally = value.cast<bool>(); }},
      {"duration_s",
       [](A& a, py::handle value, const char* name) { a.settings.client.duration_s = seconds_from(value, name); }},
      {"once", [](A& a, py::handle value, const char*) { a.settings.client.once = value.cast<bool>(); }},
      {"seed", [](A& a, py::handle value, const char*) { a.settings.client.seed = value.cast<std::uint64_t>(); }},
      {"recording",
       [](A& a, py::handle value, const char* name) { a.settings.client.recording = text_from(value, name); }},
      {"ticks_kept", [](A& a, py::handle value, const char*) { a.settings.ticks_kept = value.cast<std::size_t>(); }},
      {"key",
       [](A& a, py::handle value, const char* name) { a.settings.client.identity.key = text_from(value, name); }},
      {"server_key", [](A& a, py::handle value,
                        const char* name) { a.settings.client.identity.server_key = text_from(value, name); }},
      {"known_servers", [](A& a, py::handle value,
                           const char* name) { a.settings.client.identity.known_servers = text_from(value, name); }},
      {"shared_key", [](A& a, py::handle value,
                        const char* name) { a.settings.client.identity.shared_key = text_from(value, name); }},
      {"trust_new",
       [](A& a, py::handle value, const char*) { a.settings.client.identity.trust_new = value.cast<bool>(); }},
      {"insecure", [](A& a, py::handle value, const char*) { a.settings.client.insecure = value.cast<bool>(); }},
  };
}

std::unique_ptr<LiveClient> make_client(const py::kwargs& named) {
  AskedClient asked;
  set_fields(asked, named, client_settings(), "Client");
  LiveClient::Settings& settings = asked.settings;
  if (settings.device.facts.joints() == 0) throw py::type_error("Client: expected a device");
  settings.client.law = law_plugin::law_named(settings.client.law);
  settings.law_options = law_options(asked.memory, asked.parameters);
  settings.client.program = "Python, forcebound " FORCEBOUND_VERSION;
  const py::gil_scoped_release others_run;  // it resolves the server's name
  return std::make_unique<LiveClient>(settings);
}

}  // namespace

void bind_client(py::module_& module) {
  py::class_<LiveClient>(module, "LiveClient")
      .def(py::init(&make_client))
      .def("run", &LiveClient::run, py::call_guard<py::gil_scoped_release>())
      .def("stop", &LiveClient::stop)
      .def(
          "ticks", [](const LiveClient& self, std::size_t first) { return self.ticks().since(first); },
          py::arg("first") = 0)
      .def_property_readonly("ticks_kept", [](const LiveClient& self) { return self.ticks().kept(); })
      .def_property_readonly("ticks_not_kept", [](const LiveClient& self) { return self.ticks().not_kept(); })
      .def_property_readonly("problems", &LiveClient::problems)
      .def("summary", &LiveClient::summary)
      .def("why_no_session", &LiveClient::why_no_session);
}

}  // namespace forcebound::python
