#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "forcebound/server/app/fleet_member.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

/// The port of the sidecar of Agones beside this process; none: it is not of a fleet. Agones names it in the
/// environment (AGONES_SDK_HTTP_PORT).
/// @throws std::runtime_error if what is there is no port, or this program was built without fleets
[[nodiscard]] std::optional<std::uint16_t> fleet_port();

/// Tells the fleet's sidecar how this server is, by its REST interface, on a thread of its own. A sidecar that does not
/// answer, or not as it should, is logged once, and asked again; the server serves on.
class FleetLink {
 public:
  struct Settings {
    std::uint16_t port = 0;
    FleetMember::Options member{};
  };

  /// @param clock must outlive it
  FleetLink(const Settings& settings, const time::Clock& clock);
  /// Tells the sidecar that the server ends, for a second at most.
  ~FleetLink();
  FleetLink(const FleetLink&) = delete;
  FleetLink& operator=(const FleetLink&) = delete;

  /// Of the serving thread, after each turn. Waits for nothing while the number of sessions stays.
  void turn(std::size_t sessions);

  /// Whether the server is to end, since the sidecar was told that it does.
  [[nodiscard]] bool over() const noexcept { return over_.load(std::memory_order_relaxed); }

 private:
  void run(const std::stop_token& stop);
  void say(FleetCall call);
  [[nodiscard]] bool apply_answer(FleetCall call, const std::string& body);
  void report_fault(FleetCall call, const std::string& why);
  void log(FleetCall call);
  void wait_for_sessions(const std::stop_token& stop);

  Settings settings_;
  const time::Clock& clock_;
  std::size_t reported_sessions_ = 0;    // of the serving thread
  std::atomic<std::uint64_t> turns_{0};  // of the serving thread
  std::atomic<bool> over_{false};

  std::mutex lock_;
  std::condition_variable_any changed_;
  std::size_t sessions_ = 0;

  // Of the link's thread.
  FleetMember member_;
  bool failed_ = false;           // the last call
  std::set<FleetCall> faults_{};  // the calls whose fault was logged, each until it is answered again
  std::uint64_t healthy_turns_ = 0;
  std::jthread thread_;  // the last: it ends before what it uses
};

}  // namespace forcebound::server
