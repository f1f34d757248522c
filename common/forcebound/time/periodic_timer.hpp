#pragma once

#include <cstdint>

#include "forcebound/time/clock.hpp"

namespace forcebound::time {

/// Wakes its thread at absolute times start + n period, so that a late wake-up does not shift those after it.
///
/// Missed ticks are left out and counted, never made up for in a burst: a burst would give a law intervals that did not
/// happen.
///
/// Real time: no allocation; one system call a tick.
class PeriodicTimer {
 public:
  /// @throws std::invalid_argument unless period > 0.
  PeriodicTimer(const Clock& clock, Nanoseconds period);

  /// Sleeps until the next tick is due and returns the time of the wake-up. Signals do not shorten the sleep.
  Nanoseconds wait() noexcept;

  [[nodiscard]] Nanoseconds due() const noexcept { return due_; }
  [[nodiscard]] std::uint64_t missed() const noexcept { return missed_; }

 private:
  const Clock& clock_;
  Nanoseconds period_;
  Nanoseconds due_;
  std::uint64_t missed_ = 0;
};

}  // namespace forcebound::time
