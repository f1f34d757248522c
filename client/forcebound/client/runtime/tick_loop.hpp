#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <utility>

#include "forcebound/client/runtime/watchdog.hpp"
#include "forcebound/client/session/session.hpp"
#include "forcebound/net/peer_link.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// The real-time settings that the system granted, in words: written once by the tick's thread, read by any.
class GrantText {
 public:
  void set(std::string text) {
    text_ = std::move(text);
    known_.store(true, std::memory_order_release);
  }

  /// Null before it is known.
  [[nodiscard]] const std::string* text() const noexcept {
    return known_.load(std::memory_order_acquire) ? &text_ : nullptr;
  }

 private:
  std::string text_;
  std::atomic<bool> known_{false};
};

/// Ticks a session at the device's period on the thread that calls `run`, which it makes a real-time thread.
///
/// Missed ticks are left out and counted. When the time is up or `stop` is set, the force is zero and the session is
/// closed, which takes at most 3 s.
class TickLoop {
 public:
  struct Settings {
    Nanoseconds period;
    double duration_s = 0;         ///< 0: until stopped
    bool once = false;             ///< as Client::Settings
    bool asks_again = false;       ///< likewise
    Watchdog* watchdog = nullptr;  ///< is told of each tick; may be null
    net::PeerLink* way = nullptr;  ///< is told as long as there is a session; may be null
  };

  /// The results of a run.
  struct Outcome {
    std::uint64_t allocations = 0;  ///< in the tick, without its first second
    std::uint64_t missed_ticks = 0;
    bool gave_up = false;
  };

  /// All must outlive it.
  TickLoop(const Settings& settings, Session& session, const time::Clock& clock, GrantText& grant,
           const std::atomic<bool>& stop)
      : settings_(settings), session_(session), clock_(clock), grant_(grant), stop_(stop) {}

  /// To be called once.
  void run();

  /// Ends the loop. Any thread.
  void end() noexcept { ended_ = true; }

  /// Any thread.
  [[nodiscard]] bool done() const noexcept { return done_; }

  /// Grows as long as the loop runs, also while it closes the session. 0: it has not begun. Any thread.
  [[nodiscard]] std::uint64_t rounds() const noexcept { return rounds_; }

  /// After the end.
  [[nodiscard]] const Outcome& outcome() const noexcept { return outcome_; }

 private:
  [[nodiscard]] bool over(Nanoseconds elapsed) noexcept;

  Settings settings_;
  Session& session_;
  const time::Clock& clock_;
  GrantText& grant_;
  const std::atomic<bool>& stop_;
  Outcome outcome_;
  std::atomic<bool> ended_{false};
  std::atomic<bool> done_{false};
  std::atomic<std::uint64_t> rounds_{0};
};

}  // namespace forcebound::client
