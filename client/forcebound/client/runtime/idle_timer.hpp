#pragma once

#include <cstdint>
#include <stop_token>
#include <thread>

#include "forcebound/record/histogram.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// What this machine does to a thread that only sleeps: the yardstick for our own ticks.
///
/// Runs beside the tick, at the same period and priority, and does nothing but note when it woke.
class IdleTimer {
 public:
  IdleTimer(const time::Clock& clock, time::Nanoseconds period, int priority);

  /// Ends the thread and tells what it saw.
  [[nodiscard]] record::IdleTimer stop();

 private:
  void run(const std::stop_token& stopping, const time::Clock& clock, int priority);

  time::Nanoseconds period_;
  record::Histogram intervals_ns_;
  std::uint64_t late_ = 0;
  std::jthread thread_;  // last, so that it ends before what it writes to
};

}  // namespace forcebound::client
