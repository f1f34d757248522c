#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "forcebound/client/session/session.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// Ticks a session at the device's period on the thread that calls `run`, which it makes a real-time thread.
///
/// Missed ticks are left out and counted. When the time is up or `stop` is set, the force is zero and the session is
/// closed, which takes at most 3 s.
class TickLoop {
 public:
  struct Settings {
    Nanoseconds period;
    double duration_s = 0;  ///< 0: until stopped
    bool once = false;      ///< give up if the server refuses, or does not answer for 5 s
  };

  /// The results of a run.
  struct Outcome {
    std::string grant;              ///< real-time settings that the system granted
    std::uint64_t allocations = 0;  ///< in the tick, without its first second
    std::uint64_t missed_ticks = 0;
    bool gave_up = false;
  };

  /// All must outlive it.
  TickLoop(const Settings& settings, Session& session, const time::Clock& clock, const std::atomic<bool>& stop)
      : settings_(settings), session_(session), clock_(clock), stop_(stop) {}

  /// To be called once.
  void run();

  /// Ends the loop. Any thread.
  void end() noexcept { ended_ = true; }

  /// Any thread.
  [[nodiscard]] bool done() const noexcept { return done_; }

  /// After the end.
  [[nodiscard]] const Outcome& outcome() const noexcept { return outcome_; }

 private:
  [[nodiscard]] bool over(Nanoseconds elapsed) noexcept;

  Settings settings_;
  Session& session_;
  const time::Clock& clock_;
  const std::atomic<bool>& stop_;
  Outcome outcome_;
  std::atomic<bool> ended_{false};
  std::atomic<bool> done_{false};
};

}  // namespace forcebound::client
