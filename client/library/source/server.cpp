#include "library/source/server.hpp"

#include <cstddef>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <stop_token>
#include <utility>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/server/offer/environment_library.hpp"
#include "forcebound/server/security/key_files.hpp"
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

server::ServerOptions options_of(const fb_server_settings& given, const std::string& environment) {
  if (!(given.idle_s >= 0 && given.idle_s <= 1e6)) {
    throw std::invalid_argument("fb_server_settings.idle_s must be 0 to 1e6 s; 0: 60 s");
  }
  server::ServerOptions options{.scene = environment};
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

fb_status create(const fb_server_settings& given, const fb_environment& environment, fb_server** server) {
  expect_environment(environment);
  auto callbacks = std::make_shared<EnvironmentCallbacks>(environment);
  const server::ServerOptions options = options_of(given, callbacks->name);
  const server::KeyFiles files{.key = text_of(given.key),
                               .clients = text_of(given.clients),
                               .psk = text_of(given.shared_key),
                               .insecure = given.insecure != 0};
  server::expect_bounds(files);
  const net::Address address = net::resolve(net::parse_endpoint(text_of(given.listen, "127.0.0.1:47800")));
  server::expect_encryption(files, address);
  auto keys = server::read_keys(files, {callbacks->name});
  *server =
      std::make_unique<fb_server>(server::listen_at(address), options, std::move(callbacks), std::move(keys)).release();
  return FB_OK;
}

void run(fb_server& server, const std::stop_token& wanted) {
  server.runs_on = std::this_thread::get_id();
  std::string failure = failure_of([&] {
    server.server.run(wanted);
    return std::string();
  });
  const std::scoped_lock lock(server.mutex);
  server.failure = std::move(failure);
  server.running = false;
}

fb_status stop(fb_server& server, const char* function) {
  if (server.runs_on == std::this_thread::get_id()) {
    return refused(function, "a callback of its own asks: accepted is any other thread", FB_NOT_NOW);
  }
  const std::scoped_lock ending(server.ending);
  {
    const std::scoped_lock lock(server.mutex);
    if (!server.started) return refused(function, "it was not started", FB_NOT_NOW);
  }
  server.thread.request_stop();
  if (server.thread.joinable()) server.thread.join();
  const std::scoped_lock lock(server.mutex);
  return server.failure.empty() ? FB_OK : refused(function, server.failure, FB_FAILED);
}

fb_server_state state_of(const fb_server& server, const server::UdpServer::Figures& figures) {
  const net::Address address = server.server.address();
  fb_server_state state{};
  state.running = server.running ? 1 : 0;
  state.port = address.port;
  set_text(state.address, net::to_string(address));
  state.clients = figures.sessions;
  state.clients_refused = figures.counters.hellos_refused;
  state.motions = figures.counters.motions_received;
  state.forces = figures.counters.forces_sent;
  state.forces_zero = figures.counters.responses_unsound;
  state.callbacks_failed = server.callbacks->calls.failed();
  state.callbacks_late = server.callbacks->calls.late();
  state.busy = figures.busy;
  return state;
}

std::string summary_of(const fb_server& server) {
  const server::UdpServer::Figures figures = server.server.figures();
  const fb_server_state state = state_of(server, figures);
  nlohmann::ordered_json counts;
#define FORCEBOUND_WRITE(subject, name, words) counts[#name] = figures.counters.name;
  FORCEBOUND_SERVER_COUNTS(FORCEBOUND_WRITE)
#undef FORCEBOUND_WRITE
  for (const wire::MalformedRow& row : wire::kMalformed) {
    counts["malformed_" + std::string(row.word)] = figures.counters.malformed[row.reason];
  }
  const nlohmann::ordered_json summary{{"program", "libforcebound " FORCEBOUND_VERSION},
                                       {"address", state.address},
                                       {"environment", server.callbacks->name},
                                       {"simulated", server.callbacks->simulated},
                                       {"encryption", server.encryption},
                                       {"clients", state.clients},
                                       {"callbacks_failed", state.callbacks_failed},
                                       {"callbacks_late", state.callbacks_late},
                                       {"busy", state.busy},
                                       {"counts", counts}};
  return summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace
}  // namespace forcebound::library

using namespace forcebound;  // NOLINT(google-build-using-namespace)

namespace {

server::EnvironmentLibrary library_of(const std::shared_ptr<library::EnvironmentCallbacks>& callbacks) {
  server::EnvironmentLibrary environments;
  environments.add(library::kind_of(callbacks));
  return environments;
}

}  // namespace

fb_server::fb_server(net::UdpLink link, const server::ServerOptions& options,
                     std::shared_ptr<library::EnvironmentCallbacks> serves, std::optional<server::ServerKeys> keys)
    : callbacks(std::move(serves)),
      encryption(server::encryption_name(keys)),
      server(std::move(link), options, library_of(callbacks), nullptr, std::move(keys)) {}

fb_status fb_server_create(const fb_server_settings* settings, const fb_environment* environment, fb_server** server) {
  constexpr const char* kFunction = "fb_server_create";
  if (server == nullptr) return library::refused(kFunction, "server is null");
  const fb_server_settings standard = FB_INIT(fb_server_settings);
  const library::Given<fb_server_settings> given(kFunction, "fb_server_settings",
                                                 settings == nullptr ? &standard : settings, sizeof(std::size_t));
  if (given.status() != FB_OK) return given.status();
  const library::Given<fb_environment> felt(kFunction, "fb_environment", environment, library::kEnvironmentLeast);
  if (felt.status() != FB_OK) return felt.status();
  return library::guarded(kFunction, [&] { return library::create(*given, *felt, server); });
}

fb_status fb_server_start(fb_server* server) {
  constexpr const char* kFunction = "fb_server_start";
  if (server == nullptr) return library::refused(kFunction, "server is null");
  return library::guarded(kFunction, [&]() -> fb_status {
    const std::scoped_lock lock(server->mutex);
    if (server->started) return library::refused(kFunction, "a server runs once: make another", FB_NOT_NOW);
    server->thread = std::jthread([server](const std::stop_token& wanted) { library::run(*server, wanted); });
    server->started = true;
    server->running = true;
    return FB_OK;
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
    return library::give(kFunction, "fb_server_state", library::state_of(*server, server->server.figures()), state,
                         offsetof(fb_server_state, clients));
  });
}

fb_status fb_server_summary(fb_server* server, char* text, size_t bytes, size_t* needed) {
  constexpr const char* kFunction = "fb_server_summary";
  if (server == nullptr) return library::refused(kFunction, "server is null");
  return library::guarded(
      kFunction, [&] { return library::give_text(kFunction, library::summary_of(*server), text, bytes, needed); });
}
