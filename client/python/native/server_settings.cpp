#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "python/native/bindings.hpp"
#include "python/native/fields.hpp"
#include "python/native/live_server.hpp"

namespace forcebound::python {
namespace {

constexpr int kClientsMost = 64;

std::size_t clients_from(py::handle value, const char* name, int least) {
  return static_cast<std::size_t>(whole_from(value, name, least, kClientsMost));
}

time::Nanoseconds idle_from(py::handle value, const char* name) {
  const double idle_s = seconds_from(value, name);
  if (idle_s >= 1) return time::from_seconds(idle_s);
  throw py::value_error(std::string(name) + " must be 1 to 1e6 s, got " + py::str(value).cast<std::string>());
}

std::vector<Setting<LiveServer::Settings>> server_settings() {
  using S = LiveServer::Settings;
  using Keys = server::KeyFiles;
  using Probe = server::ProbeFacts;
  const auto keys = [](const char* name, auto member) {
    return setting<S>(name, [member](S& s) { return &(s.server.keys.*member); });
  };
  const auto probe = [](const char* name, auto member) {
    return setting<S>(name, [member](S& s) { return &(s.probe.*member); });
  };
  return {
      setting<S>("name", [](S& s) { return &s.offer.name; }),
      setting<S>("simulated", [](S& s) { return &s.offer.simulated; }),
      setting<S>("listen", [](S& s) { return &s.server.listen; }),
      keys("key", &Keys::key),
      keys("clients", &Keys::clients),
      keys("shared_key", &Keys::psk),
      keys("insecure", &Keys::insecure),
      {"clients_max",
       [](S& s, py::handle value, const char* name) { s.server.options.sessions_max = clients_from(value, name, 1); }},
      {"clients_per_address",
       [](S& s, py::handle value, const char* name) {
         s.server.options.sessions_per_address = clients_from(value, name, 0);
       }},
      {"idle_s",
       [](S& s, py::handle value, const char* name) { s.server.options.idle_timeout = idle_from(value, name); }},
      probe("probe_radius_m", &Probe::radius_m),
      probe("probe_mass_kg", &Probe::mass_kg),
      probe("probe_stiffness_N_per_m", &Probe::stiffness_N_per_m),
      probe("probe_damping_N_s_per_m", &Probe::damping_N_s_per_m),
  };
}

std::unique_ptr<LiveServer> make_server(const py::kwargs& named) {
  LiveServer::Settings settings;
  set_fields(settings, named, server_settings(), "Server");
  if (settings.offer.name.empty()) throw py::value_error("name must be a name, got an empty text");
  if (settings.offer.simulated.empty()) settings.offer.simulated = settings.offer.name;
  const py::gil_scoped_release others_run;  // it resolves the address's name
  return std::make_unique<LiveServer>(settings);
}

}  // namespace

void bind_server(py::module_& module) {
  const py::call_guard<py::gil_scoped_release> others_run;
  py::class_<LiveServer>(module, "LiveServer")
      .def(py::init(&make_server))
      .def("start", &LiveServer::start, others_run)
      .def("stop", &LiveServer::stop, others_run)
      .def("ask", &LiveServer::ask)
      .def("report", &LiveServer::report, py::arg("client"), py::arg("touches"))
      .def("is_running", &LiveServer::is_running)
      .def_property_readonly("address", &LiveServer::address)
      .def("summary", &LiveServer::summary, others_run);
}

}  // namespace forcebound::python
