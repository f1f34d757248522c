#pragma once

#include <optional>
#include <stop_token>
#include <thread>

#include "forcebound/record/run_info.hpp"
#include "forcebound/record/wake_ups.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::record {

/// Measures the wake-up jitter of a thread that only sleeps: the reference for that of a loop.
///
/// Runs beside the loop, at the same period and priority, and only notes its wake-ups.
class IdleThread {
 public:
  /// @param priority asked for, SCHED_FIFO; none: as any thread
  IdleThread(const time::Clock& clock, time::Nanoseconds period, std::optional<int> priority);

  /// Ends the thread and returns its measurement.
  [[nodiscard]] IdleTimer stop();

 private:
  void run(const std::stop_token& stopping, const time::Clock& clock, std::optional<int> priority);

  time::Nanoseconds period_;
  WakeUps wake_ups_;
  std::jthread thread_;  // last, so that it ends before the members that it writes to
};

}  // namespace forcebound::record
