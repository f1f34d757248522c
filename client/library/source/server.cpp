#include "library/source/server.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/server/simulator/simulator_environment.hpp"
#include "library/source/errors.hpp"
#include "library/source/structs.hpp"

namespace forcebound::library {
namespace {

constexpr std::size_t kEnvironmentLeast = offsetof(fb_environment, destroy);

std::size_t count_of(const char* name, std::int32_t given, std::size_t standard) {
  if (given < 0) {
    throw std::invalid_argument(std::string("fb_server_settings.") + name + " must be at least 0, got " +
                                std::to_string(given));
  }
  return given == 0 ? standard : static_cast<std::size_t>(given);
}

server::ServerOptions options_of(const fb_server_settings& given) {
  if (!(given.idle_s >= 0 && given.idle_s <= 1e6)) {
    throw std::invalid_argument("fb_server_settings.idle_s must be 0 to 1e6 s; 0: 60 s");
  }
  server::ServerOptions options;
  options.sessions_max = count_of("clients_max", given.clients_max, options.sessions_max);
  options.sessions_per_address = count_of("clients_per_address", given.clients_per_address, 0);
  if (given.idle_s > 0) options.idle_timeout = time::from_seconds(given.idle_s);
  return options;
}

void expect_environment(const fb_environment& given) {
  if (given.update == nullptr) {
    throw std::invalid_argument("fb_environment.update must be a function, got null");
  }
  if (given.axes < 0 || given.axes > FB_AXES_MAX) {
    throw std::invalid_argument("fb_environment.axes must be 0 to " + std::to_string(FB_AXES_MAX) + ", got " +
                                std::to_string(given.axes));
  }
  if (given.name != nullptr && *given.name == '\0') {
    throw std::invalid_argument("fb_environment.name must be a name, or null; it is empty");
  }
}

Served served_by(const fb_environment& given) {
  expect_environment(given);
  auto callbacks = std::make_shared<EnvironmentCallbacks>(given);
  return {.kind = kind_of(callbacks), .simulated = callbacks->simulated, .callbacks = callbacks};
}

Served served_by(const fb_simulator& given, std::size_t clients_most) {
  const std::string name = text_of(given.name, "simulator");
  if (name.empty()) throw std::invalid_argument("fb_simulator.name must be a name, or null; it is empty");
  const server::ProbeFacts standard;
  const auto or_standard = [](double value, double otherwise) { return value == 0 ? otherwise : value; };
  const auto simulator = std::make_shared<server::Simulator>(
      server::ProbeFacts{.radius_m = given.probe_radius_m,
                         .mass_kg = or_standard(given.probe_mass_kg, standard.mass_kg),
                         .stiffness_N_per_m = or_standard(given.probe_stiffness_N_per_m, standard.stiffness_N_per_m),
                         .damping_N_s_per_m = or_standard(given.probe_damping_N_s_per_m, standard.damping_N_s_per_m)},
      static_cast<int>(clients_most));
  const std::string simulated = text_of(given.simulated, name);
  return {.kind = server::simulator_environment({.name = name, .simulated = simulated}, simulator),
          .simulated = simulated,
          .simulator = simulator};
}

fb_status create(const fb_server_settings& given, const server::ServerOptions& options, Served served,
                 fb_server** server) {
  const server::EmbeddedServer::Settings settings{.listen = text_of(given.listen, "127.0.0.1:47800"),
                                                  .keys = {.key = text_of(given.key),
                                                           .clients = text_of(given.clients),
                                                           .psk = text_of(given.shared_key),
                                                           .insecure = given.insecure != 0},
                                                  .options = options};
  *server =
      new fb_server{.served = served, .server = {settings, served.kind, served.simulated}};  // NOLINT(*-owning-memory)
  return FB_OK;
}

/// Of what a program gave, by `serve`, which may change the options.
/// @param what the struct's name @param least bytes of it that must be there
template <class Struct, class Serve>
fb_status create(const char* function, const fb_server_settings* settings, const char* what, const Struct* served,
                 std::size_t least, fb_server** server, const Serve& serve) {
  if (server == nullptr) return refused(function, "server is null");
  const fb_server_settings standard = FB_INIT(fb_server_settings);
  const Given<fb_server_settings> given(function, "fb_server_settings", settings == nullptr ? &standard : settings,
                                        sizeof(std::size_t));
  if (given.status() != FB_OK) return given.status();
  const Given<Struct> felt(function, what, served, least);
  if (felt.status() != FB_OK) return felt.status();
  return guarded(function, [&] {
    server::ServerOptions options = options_of(*given);
    Served made = serve(*felt, options);
    return create(*given, options, std::move(made), server);
  });
}

fb_status stop(fb_server& server, const char* function) {
  using Stopped = server::EmbeddedServer::Stopped;
  switch (server.server.stop()) {
    case Stopped::not_by_itself:
      return refused(function, "a callback of its own asks: accepted is any other thread", FB_NOT_NOW);
    case Stopped::never_started:
      return refused(function, "it was not started", FB_NOT_NOW);
    case Stopped::with_failure:
      return refused(function, server.server.failure(), FB_FAILED);
    case Stopped::now:
      break;
  }
  return FB_OK;
}

fb_server_state state_of(const fb_server& server) {
  const net::Address address = server.server.address();
  const server::UdpServer::Figures figures = server.server.figures();
  fb_server_state state{};
  state.running = server.server.is_running() ? 1 : 0;
  state.port = address.port;
  set_text(state.address, net::to_string(address));
  state.clients = figures.sessions;
  state.clients_refused = figures.counters.hellos_refused;
  state.motions = figures.counters.motions_received;
  state.forces = figures.counters.forces_sent;
  state.forces_zero = figures.counters.responses_unsound;
  if (server.served.callbacks != nullptr) {
    state.callbacks_failed = server.served.callbacks->calls.failed();
    state.callbacks_late = server.served.callbacks->calls.late();
  }
  state.busy = figures.busy;
  if (server.served.simulator != nullptr) {
    const server::Simulator::Counts counts = server.served.simulator->counts();
    state.reports = counts.reports;
    state.reports_refused = counts.reports_refused;
    state.silences = counts.silences;
  }
  return state;
}

std::string summary_of(const fb_server& server) {
  const fb_server_state state = state_of(server);
  const std::array own{server::EmbeddedServer::OwnCount{"callbacks_failed", state.callbacks_failed},
                       server::EmbeddedServer::OwnCount{"callbacks_late", state.callbacks_late},
                       server::EmbeddedServer::OwnCount{"reports", state.reports},
                       server::EmbeddedServer::OwnCount{"reports_refused", state.reports_refused},
                       server::EmbeddedServer::OwnCount{"silences", state.silences}};
  return server.server.summary("libforcebound " FORCEBOUND_VERSION, own);
}

}  // namespace
}  // namespace forcebound::library

using namespace forcebound;  // NOLINT(google-build-using-namespace)

fb_status fb_server_create(const fb_server_settings* settings, const fb_environment* environment, fb_server** server) {
  return library::create(
      "fb_server_create", settings, "fb_environment", environment, library::kEnvironmentLeast, server,
      [](const fb_environment& given, const server::ServerOptions& /*options*/) { return library::served_by(given); });
}

fb_status fb_server_of_simulator(const fb_server_settings* settings, const fb_simulator* simulator,
                                 fb_server** server) {
  return library::create("fb_server_of_simulator", settings, "fb_simulator", simulator, sizeof(std::size_t), server,
                         [](const fb_simulator& given, server::ServerOptions& options) {
                           options.sessions_max = std::min(options.sessions_max, library::kProbesMost);
                           return library::served_by(given, options.sessions_max);
                         });
}

fb_status fb_server_start(fb_server* server) {
  constexpr const char* kFunction = "fb_server_start";
  if (server == nullptr) return library::refused(kFunction, "server is null");
  return library::guarded(kFunction, [&] {
    return server->server.start() ? FB_OK : library::refused(kFunction, "a server runs once: make another", FB_NOT_NOW);
  });
}

fb_status fb_server_stop(fb_server* server) {
  constexpr const char* kFunction = "fb_server_stop";
  if (server == nullptr) return library::refused(kFunction, "server is null");
  return library::guarded(kFunction, [&] { return library::stop(*server, kFunction); });
}

void fb_server_destroy(fb_server* server) { delete server; }

fb_status fb_server_look(fb_server* server, fb_server_state* state) {
  constexpr const char* kFunction = "fb_server_look";
  if (server == nullptr) return library::refused(kFunction, "server is null");
  return library::guarded(kFunction, [&] {
    return library::give(kFunction, "fb_server_state", library::state_of(*server), state,
                         offsetof(fb_server_state, clients));
  });
}

fb_status fb_server_summary(fb_server* server, char* text, size_t bytes, size_t* needed) {
  constexpr const char* kFunction = "fb_server_summary";
  if (server == nullptr) return library::refused(kFunction, "server is null");
  return library::guarded(
      kFunction, [&] { return library::give_text(kFunction, library::summary_of(*server), text, bytes, needed); });
}
