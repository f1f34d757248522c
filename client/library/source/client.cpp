#include "library/source/client.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <new>
#include <random>
#include <stdexcept>
#include <utility>

#include "forcebound/baselines/law_file.hpp"
#include "forcebound/control/wrench.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/text/setting_names.hpp"
#include "library/source/errors.hpp"
#include "library/source/structs.hpp"

namespace forcebound::library {

record::TickRecord NewestTick::get() {
  const std::scoped_lock lock(mutex_);
  if (const record::TickRecord* const newer = newest_.take()) seen_ = *newer;
  return seen_;
}

void Events::add(const fb_event& event) {
  const std::scoped_lock lock(mutex_);
  if (event.kind == FB_EVENT_WELCOMED) simulated_ = event.text;
  if (waiting_.size() < kMost) {
    waiting_.push_back(event);
  } else {
    ++lost_;
  }
}

bool Events::take(fb_event& event) {
  const std::scoped_lock lock(mutex_);
  if (waiting_.empty()) return false;
  event = waiting_.front();
  waiting_.pop_front();
  return true;
}

std::uint64_t Events::lost() const {
  const std::scoped_lock lock(mutex_);
  return lost_;
}

std::string Events::simulated() const {
  const std::scoped_lock lock(mutex_);
  return simulated_;
}

namespace {

// As they are in forcebound.h.
static_assert(static_cast<int>(client::Event::Kind::welcomed) == FB_EVENT_WELCOMED);
static_assert(static_cast<int>(client::Event::Kind::scene_here) == FB_EVENT_SCENE_HERE);
static_assert(static_cast<int>(client::Event::Kind::tool_lost) == FB_EVENT_TOOL_LOST);
static_assert(static_cast<int>(record::SessionState::reconnecting) == FB_SESSION_RECONNECTING);

constexpr std::size_t kSettingsLeast = offsetof(fb_client_settings, scene);

fb_event event_of(int kind, std::string_view text, time::Nanoseconds duration = {}) {
  fb_event event{};
  event.size = sizeof event;
  event.kind = kind;
  event.duration_s = time::to_seconds(duration);
  set_text(event.text, text);
  return event;
}

client::EmbeddedClient::Settings settings_of(const fb_client_settings& given, const OpenedDevice& opened) {
  const std::string law = law_plugin::law_named(text_of(given.law, "fba-exact"));
  client::EmbeddedClient::Settings settings{.client = {.server = text_of(given.server),
                                                       .identity = {.key = text_of(given.key),
                                                                    .server_key = text_of(given.server_key),
                                                                    .known_servers = text_of(given.known_servers),
                                                                    .shared_key = text_of(given.shared_key),
                                                                    .trust_new = given.trust_new != 0},
                                                       .insecure = given.insecure != 0,
                                                       .scene = text_of(given.scene),
                                                       .renders_locally = given.remote_rendering == 0,
                                                       .seed = std::random_device{}(),
                                                       .duration_s = given.duration_s,
                                                       .once = given.once != 0,
                                                       .recording = text_of(given.recording),
                                                       // Another's simulated devices may run in this process, too.
                                                       .beside = opened.device->is_simulated(),
                                                       .outlives_device = opened.callbacks != nullptr,
                                                       .program = "libforcebound " FORCEBOUND_VERSION,
                                                       .law = law,
                                                       .hand = opened.hand}};
  if (given.law_parameters != nullptr) {
    settings.law_options.parameters =
        baselines::parse_law_parameters(given.law_parameters, "law_parameters", law, law_plugin::known_laws());
  }
  return settings;
}

fb_status create(const fb_client_settings& given, const fb_device& device, fb_client** client) {
  if (!(given.duration_s >= 0 && given.duration_s <= 1e6)) {
    throw std::invalid_argument("duration_s must be 0 to 1e6 s; 0: until stopped");
  }
  if (device.opened->in_use.exchange(true)) {
    return refused("fb_client_create", "another client has this device: destroy it first", FB_NOT_NOW);
  }
  try {
    *client = std::make_unique<fb_client>(settings_of(given, *device.opened), device.opened).release();
    return FB_OK;
  } catch (...) {
    device.opened->in_use = false;
    throw;
  }
}

void run(fb_client& client) {
  std::string failure = failure_of([&] {
    client.client.run();
    return client.client.why_no_session();
  });
  const std::scoped_lock lock(client.mutex);
  client.failure = std::move(failure);
  client.ended = true;
  client.running = false;
  client.changed.notify_all();
}

fb_status wait(fb_client& client, const char* function, double timeout_s) {
  std::unique_lock lock(client.mutex);
  if (!client.started) return refused(function, "it was not started", FB_NOT_NOW);
  const auto has_ended = [&] { return client.ended; };
  constexpr double kMost_s = 1e6;
  if (timeout_s < 0) {
    client.changed.wait(lock, has_ended);
  } else if (!client.changed.wait_for(lock, std::chrono::duration<double>(std::min(timeout_s, kMost_s)), has_ended)) {
    return refused(function, "it still runs", FB_NOT_NOW);
  }
  return client.failure.empty() ? FB_OK : refused(function, client.failure, FB_FAILED);
}

void set_wrench(double (&to)[FB_AXES_MAX], const control::Vector& force_N, const control::Vector& torque_N_m) noexcept {
  const auto at = std::copy_n(force_N.data(), force_N.rows(), to);
  std::copy_n(torque_N_m.data(), std::min<Eigen::Index>(torque_N_m.rows(), to + FB_AXES_MAX - at), at);
}

fb_client_state state_of(fb_client& client) {
  const record::TickRecord tick = client.newest.get();
  fb_client_state state{};
  state.ticks = tick.tick;
  state.running = client.running ? 1 : 0;
  state.session = static_cast<std::int32_t>(tick.state);
  std::copy_n(tick.position.data(), tick.position.rows(), state.position_m);
  set_wrench(state.request_N, tick.request, tick.request_torque_N_m);
  set_wrench(state.force_N, tick.applied, tick.applied_torque_N_m);
  state.force_age_s = time::to_seconds(tick.force_age);
  state.contact = tick.contact ? 1 : 0;
  state.buttons = tick.handle.buttons.value_or(0);
  state.depth_m = tick.contact ? tick.penetration_m : 0;
  if (tick.handle.orientation) std::ranges::copy(*tick.handle.orientation, state.orientation);
  state.gripper = tick.handle.gripper.value_or(0);
  if (const CallbackDevice* const callbacks = client.opened->callbacks) {
    state.callbacks_failed = callbacks->calls().failed();
    state.callbacks_late = callbacks->calls().late();
  }
  state.events_lost = client.events.lost();
  set_text(state.simulated, client.events.simulated());
  return state;
}

}  // namespace
}  // namespace forcebound::library

using namespace forcebound;  // NOLINT(google-build-using-namespace)

fb_client::fb_client(const client::EmbeddedClient::Settings& settings, std::shared_ptr<library::OpenedDevice> used)
    : opened(std::move(used)),
      client(settings, *opened->device, {&newest},
             {.event =
                  [this](const client::Event& event) {
                    events.add(library::event_of(static_cast<int>(event.kind), text::with_setting_names(event.words()),
                                                 event.duration));
                  },
              .problem =
                  [this](const std::string& problem) { events.add(library::event_of(FB_EVENT_PROBLEM, problem)); }}) {}

fb_client::~fb_client() {
  client.stop();
  if (thread.joinable()) thread.join();
  opened->in_use = false;
}

fb_status fb_client_create(const fb_client_settings* settings, fb_device* device, fb_client** client) {
  constexpr const char* kFunction = "fb_client_create";
  if (device == nullptr || client == nullptr) return library::refused(kFunction, "device or client is null");
  const library::Given<fb_client_settings> given(kFunction, "fb_client_settings", settings, library::kSettingsLeast);
  if (given.status() != FB_OK) return given.status();
  if (given->server == nullptr) {
    return library::refused(kFunction, "fb_client_settings.server must be HOST:PORT, got null");
  }
  return library::guarded(kFunction, [&]() -> fb_status { return library::create(*given, *device, client); });
}

fb_status fb_client_start(fb_client* client) {
  constexpr const char* kFunction = "fb_client_start";
  if (client == nullptr) return library::refused(kFunction, "client is null");
  return library::guarded(kFunction, [&]() -> fb_status {
    const std::scoped_lock lock(client->mutex);
    if (client->started) return library::refused(kFunction, "a client runs once: make another", FB_NOT_NOW);
    client->thread = std::jthread([client] { library::run(*client); });
    client->started = true;
    client->running = true;
    return FB_OK;
  });
}

fb_status fb_client_wait(fb_client* client, double timeout_s) {
  if (client == nullptr) return library::refused("fb_client_wait", "client is null");
  if (std::isnan(timeout_s)) return library::refused("fb_client_wait", "timeout_s must be a number");
  return library::guarded("fb_client_wait", [&] { return library::wait(*client, "fb_client_wait", timeout_s); });
}

fb_status fb_client_stop(fb_client* client) {
  if (client == nullptr) return library::refused("fb_client_stop", "client is null");
  client->client.stop();
  return library::guarded("fb_client_stop", [&] { return library::wait(*client, "fb_client_stop", -1); });
}

void fb_client_destroy(fb_client* client) { delete client; }

fb_status fb_client_look(fb_client* client, fb_client_state* state) {
  if (client == nullptr) return library::refused("fb_client_look", "client is null");
  return library::guarded("fb_client_look", [&] {
    return library::give("fb_client_look", "fb_client_state", library::state_of(*client), state,
                         offsetof(fb_client_state, position_m));
  });
}

fb_status fb_client_ledger(fb_client* client, fb_ledger* ledger) {
  if (client == nullptr) return library::refused("fb_client_ledger", "client is null");
  return library::guarded("fb_client_ledger", [&] {
    const record::TickRecord tick = client->newest.get();
    fb_ledger now{};
    now.energy_J = tick.energy_J;
    now.share_credited = tick.xi;
    now.audited = client->opened->device->is_simulated() ? 1 : 0;
    now.P_J = tick.audit_J;
    now.P_J_least = tick.audit_minimum_J;
    return library::give("fb_client_ledger", "fb_ledger", now, ledger, offsetof(fb_ledger, audited));
  });
}

fb_status fb_client_event(fb_client* client, fb_event* event) {
  constexpr const char* kFunction = "fb_client_event";
  if (client == nullptr) return library::refused(kFunction, "client is null");
  return library::guarded(kFunction, [&]() -> fb_status {
    // What cannot be given is not taken.
    fb_event taken{};
    const fb_status fits = event == nullptr
                               ? library::refused_null(kFunction, "fb_event")
                               : library::expect_size(kFunction, "fb_event", *event, offsetof(fb_event, duration_s));
    if (fits != FB_OK) return fits;
    if (!client->events.take(taken)) return FB_NOTHING;
    return library::give(kFunction, "fb_event", taken, event, offsetof(fb_event, duration_s));
  });
}

fb_status fb_client_summary(fb_client* client, char* text, size_t bytes, size_t* needed) {
  constexpr const char* kFunction = "fb_client_summary";
  if (client == nullptr) return library::refused(kFunction, "client is null");
  return library::guarded(kFunction, [&]() -> fb_status {
    if (!client->client.ended()) {
      return library::refused(kFunction, "there is no summary before the client has ended", FB_NOT_NOW);
    }
    return library::give_text(kFunction, client->client.summary(), text, bytes, needed);
  });
}
