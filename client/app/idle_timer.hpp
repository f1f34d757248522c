#pragma once

#include <stop_token>
#include <thread>

#include "forcebound/record/histogram.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// What this machine does to a thread that only sleeps: the yardstick for our own ticks.
///
/// Runs beside the tick, at the same period and priority, half a period apart, and does nothing but note when it woke.
class IdleTimer {
 public:
  IdleTimer(const time::Clock& clock, time::Nanoseconds period, int priority);

  /// Ends the thread. Afterwards the intervals between its wake-ups can be read.
  const record::Histogram& stop();

 private:
  void run(const std::stop_token& stopping, const time::Clock& clock, time::Nanoseconds period, int priority);

  record::Histogram intervals_ns_;
  std::jthread thread_;  // last, so that it ends before what it writes to
};

}  // namespace forcebound::client
