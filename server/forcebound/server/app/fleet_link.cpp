#include "forcebound/server/app/fleet_link.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdlib>
#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "forcebound/http/client.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;

constexpr const char* kPort = "AGONES_SDK_HTTP_PORT";
constexpr const char* kHost = "127.0.0.1";
constexpr Nanoseconds kAnswer = 2s;
constexpr Nanoseconds kLastAnswer = 1s;
constexpr Nanoseconds kWait = 100ms;
constexpr int kGood = 200;

/// The counter of a GameServer that has the number of sessions.
constexpr const char* kCounter = "sessions";

struct Sent {
  std::string target;
  http::Request request;
};

Sent words_of(FleetCall call, std::size_t sessions, std::size_t places) {
  switch (call) {
    case FleetCall::ready:
      return {"/ready", {"POST", "{}"}};
    case FleetCall::allocate:
      return {"/allocate", {"POST", "{}"}};
    case FleetCall::shut_down:
      return {"/shutdown", {"POST", "{}"}};
    case FleetCall::health:
      return {"/health", {"POST", "{}"}};
    case FleetCall::count: {
      const nlohmann::json counts{{"count", std::to_string(sessions)}, {"capacity", std::to_string(places)}};
      return {std::string("/v1beta1/counters/") + kCounter, {"PATCH", counts.dump()}};
    }
    case FleetCall::look:
    case FleetCall::none:
      break;
  }
  return {"/gameserver", {"GET", ""}};
}

}  // namespace

std::optional<std::uint16_t> fleet_port() {
  const char* const text = std::getenv(kPort);
  if (text == nullptr || *text == 0) return std::nullopt;
  if (!http::refusal().empty()) {
    throw std::runtime_error(std::string(kPort) + " in the environment: " + std::string(http::refusal()));
  }
  const auto port = text::whole_number<std::uint16_t>(text);
  if (port && *port > 0) return port;
  throw std::runtime_error(std::string(kPort) + " in the environment must be a port from 1 to 65535, got '" + text +
                           "'");
}

FleetLink::FleetLink(const Settings& settings, const time::Clock& clock)
    : settings_(settings),
      clock_(clock),
      member_(settings.member),
      thread_([this](const std::stop_token& stop) { run(stop); }) {
  spdlog::info("fleet: telling the sidecar at {}:{} how this server is", kHost, settings.port);
}

FleetLink::~FleetLink() {
  thread_.request_stop();
  changed_.notify_all();
}

void FleetLink::turn(std::size_t sessions) {
  turns_.fetch_add(1, std::memory_order_relaxed);
  if (sessions == reported_sessions_) return;
  reported_sessions_ = sessions;
  {
    const std::scoped_lock lock(lock_);
    sessions_ = sessions;
  }
  changed_.notify_all();
}

void FleetLink::wait_for_sessions(const std::stop_token& stop) {
  std::unique_lock lock(lock_);
  changed_.wait_for(lock, stop, kWait, [this] { return sessions_ != member_.sessions(); });
  member_.set_sessions(sessions_, clock_.now());
}

void FleetLink::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    wait_for_sessions(stop);
    FleetCall call = FleetCall::none;
    do {
      const bool turning = turns_.load(std::memory_order_relaxed) != healthy_turns_;
      call = member_.next(clock_.now(), turning);
      if (call != FleetCall::none) say(call);
    } while (call != FleetCall::none && !stop.stop_requested());
    if (member_.shut_down()) over_.store(true, std::memory_order_relaxed);
  }
  if (member_.shut_down() || failed_) return;
  member_.leave();
  if (member_.next(clock_.now(), false) == FleetCall::shut_down) say(FleetCall::shut_down);
}

void FleetLink::say(FleetCall call) {
  const Sent sent = words_of(call, member_.count(), member_.places());
  const http::Url url{.host = kHost, .port = std::to_string(settings_.port), .target = sent.target};
  try {
    const auto turns = turns_.load(std::memory_order_relaxed);
    const http::Response answer = http::ask(url, sent.request, call == FleetCall::shut_down ? kLastAnswer : kAnswer);
    if (answer.status != kGood) {
      const std::string why = sent.target + " was answered with HTTP status " + std::to_string(answer.status);
      if (call != FleetCall::count) return report_fault(call, why);
      spdlog::warn("fleet: the number of sessions is not told: {}; the fleet's GameServer needs a counter '{}'", why,
                   kCounter);
      return member_.refused(call);
    }
    if (call == FleetCall::health) healthy_turns_ = turns;
    if (!apply_answer(call, answer.body)) {
      return report_fault(call, "/gameserver was answered with what is no state of a GameServer");
    }
    failed_ = false;
    // The others may have been answered all the time.
    if (faults_.erase(call) > 0) spdlog::info("fleet: the sidecar answers again: {}", sent.target);
  } catch (const std::exception& error) {
    report_fault(call, error.what());
  }
}

/// Whether the answer is one to that call.
bool FleetLink::apply_answer(FleetCall call, const std::string& body) {
  const Nanoseconds now = clock_.now();
  log(call);
  member_.done(call, now);
  if (call != FleetCall::look) return true;
  const auto state = read_fleet_state(body);
  if (!state) return false;
  const bool before = member_.allocated();
  member_.apply_state(*state, now);
  if (!before && member_.allocated()) spdlog::info("fleet: allocated by the fleet, waiting for a client");
  return true;
}

void FleetLink::log(FleetCall call) {
  if (call == FleetCall::ready && !member_.allocated()) spdlog::info("fleet: ready");
  if (call == FleetCall::ready && member_.allocated()) {
    spdlog::info("fleet: ready again: {}", member_.used() ? "the last client has left" : "no client came");
  }
  if (call == FleetCall::allocate) {
    spdlog::info("fleet: allocated, with {}", text::counted(member_.sessions(), "session"));
  }
  if (call == FleetCall::shut_down) spdlog::info("fleet: shut down");
}

void FleetLink::report_fault(FleetCall call, const std::string& why) {
  member_.failed(clock_.now());
  failed_ = true;
  if (!faults_.insert(call).second) return;
  spdlog::warn("fleet: the sidecar does not answer: {}; serving on and asking again", why);
}

}  // namespace forcebound::server
