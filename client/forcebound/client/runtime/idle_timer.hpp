#pragma once

#include <cstdint>
#include <stop_token>
#include <thread>

#include "forcebound/record/histogram.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// Measures the wake-up jitter of a thread that only sleeps: the reference for the tick's own.
///
/// Runs beside the tick, at the same period and priority, and only notes its wake-ups.
class IdleTimer {
 public:
  IdleTimer(const time::Clock& clock, time::Nanoseconds period, int priority);

  /// Ends the thread and returns its measurement.
  [[nodiscard]] record::IdleTimer stop();

 private:
  void run(const std::stop_token& stopping, const time::Clock& clock, int priority);

  time::Nanoseconds period_;
  record::Histogram intervals_ns_;
  std::uint64_t late_ = 0;
  std::jthread thread_;  // last, so that it ends before the members that it writes to
};

}  // namespace forcebound::client
