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

std::vector<Setting<AskedClient>> client_settings() {
  using A = AskedClient;
  using Client = client::Client::Settings;
  using Keys = client::IdentityFiles;
  const auto client = [](const char* name, auto member) {
    return setting<A>(name, [member](A& a) { return &(a.settings.client.*member); });
  };
  const auto keys = [](const char* name, auto member) {
    return setting<A>(name, [member](A& a) { return &(a.settings.client.identity.*member); });
  };
  return {client("server", &Client::server),
          setting<A>("device", [](A& a) { return &a.settings.device; }),
          client("hand", &Client::hand),
          client("law", &Client::law),
          setting<A>("memory", [](A& a) { return &a.memory; }),
          setting<A>("parameters", [](A& a) { return &a.parameters; }),
          client("scene", &Client::scene),
          client("renders_locally", &Client::renders_locally),
          {"duration_s",
           [](A& a, py::handle value, const char* name) { a.settings.client.duration_s = seconds_from(value, name); }},
          client("once", &Client::once),
          client("seed", &Client::seed),
          client("recording", &Client::recording),
          setting<A>("ticks_kept", [](A& a) { return &a.settings.ticks_kept; }),
          keys("key", &Keys::key),
          keys("server_key", &Keys::server_key),
          keys("known_servers", &Keys::known_servers),
          keys("shared_key", &Keys::shared_key),
          keys("trust_new", &Keys::trust_new),
          client("insecure", &Client::insecure)};
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
