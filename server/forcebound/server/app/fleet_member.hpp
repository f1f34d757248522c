#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// What a server of a fleet can tell the fleet's sidecar, or ask it.
enum class FleetCall : std::uint8_t { none, ready, allocate, shut_down, health, count, look };

/// What a server does when its last client has left.
enum class AfterUse : std::uint8_t {
  ready,      ///< it waits for the next
  shut_down,  ///< it ends, and the fleet starts a fresh one
};

/// What the sidecar knows of this server.
struct FleetState {
  bool allocated = false;
  Nanoseconds health_period{0};  ///< at least so often the sidecar wants to hear that it is healthy; 0: never
};

/// Reads the sidecar's answer about this server, JSON. Nothing: it is none.
[[nodiscard]] std::optional<FleetState> read_fleet_state(std::string_view json);

/// Decides what a server tells its fleet (Agones), and when. Ready: the fleet may give it away or end it. Allocated: it
/// is in use, and the fleet lets it live.
///
/// * It is ready once it serves, and says that it is healthy only while the serving thread turns.
/// * The first session makes it allocated, whoever sent the client.
/// * When the last session has been gone for `empty`, it is ready again or shuts down, as `after_use` says. A client
///   that comes back within `empty` finds it allocated.
/// * Allocated by the fleet, it waits `arrival` for its client, and is then ready again.
/// * Its number of sessions is told when it changes, and anew after each `arrival`: the allocator counts a client
/// before
///   it comes, who may not come. Before it shuts down it is told to be full, so that nobody is sent there.
///
/// Time is an argument; not thread-safe.
class FleetMember {
 public:
  struct Options {
    AfterUse after_use = AfterUse::ready;
    std::size_t places = 1;  ///< sessions at the same time
    Nanoseconds arrival{std::chrono::seconds{60}};
    Nanoseconds empty{std::chrono::seconds{5}};
    Nanoseconds settle{std::chrono::seconds{2}};  ///< until the sidecar shows what it was told
    Nanoseconds look{std::chrono::seconds{2}};    ///< from one look to the next
  };

  explicit FleetMember(const Options& options) : options_(options) {}

  void set_sessions(std::size_t sessions, Nanoseconds now) noexcept;

  /// The server ends: what is left to say is to shut down.
  void leave() noexcept { leaving_ = true; }

  /// What is to be said now. @param turning the serving thread turned since it was last healthy
  [[nodiscard]] FleetCall next(Nanoseconds now, bool turning) const noexcept;

  /// The sidecar took the call.
  void done(FleetCall call, Nanoseconds now) noexcept;

  /// It does not know the call: of the number of sessions only, which is not said again.
  void refused(FleetCall call) noexcept;

  /// It did not answer: nothing is said for a while, the longer the more often that happened.
  void failed(Nanoseconds now) noexcept;

  void apply_state(const FleetState& state, Nanoseconds now) noexcept;

  [[nodiscard]] bool allocated() const noexcept { return allocated_; }
  [[nodiscard]] bool used() const noexcept { return used_; }
  [[nodiscard]] bool shut_down() const noexcept { return shut_down_; }
  [[nodiscard]] std::size_t sessions() const noexcept { return sessions_; }
  [[nodiscard]] std::size_t places() const noexcept { return options_.places; }
  /// The number of sessions to be told.
  [[nodiscard]] std::size_t count() const noexcept { return is_about_to_shut_down() ? options_.places : sessions_; }

 private:
  [[nodiscard]] bool is_about_to_shut_down() const noexcept {
    return options_.after_use == AfterUse::shut_down && allocated_ && used_ && sessions_ == 0;
  }
  [[nodiscard]] FleetCall life_cycle(Nanoseconds now) const noexcept;

  Options options_;
  std::size_t sessions_ = 0;
  std::optional<std::size_t> counted_{};  ///< as the sidecar was told
  bool can_count_ = true;
  bool reported_ready_ = false;
  bool allocated_ = false;
  bool used_ = false;  ///< since it is allocated
  bool shut_down_ = false;
  bool leaving_ = false;
  Nanoseconds reported_{0};  ///< when its state was last told
  Nanoseconds since_{0};     ///< when it was allocated, or its last session ended
  Nanoseconds health_period_{std::chrono::seconds{2}};
  Nanoseconds next_health_{0};
  Nanoseconds next_look_{0};
  Nanoseconds next_count_{0};
  Nanoseconds pause_{0};
  Nanoseconds silent_until_{0};
};

}  // namespace forcebound::server
