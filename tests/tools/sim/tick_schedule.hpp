#pragma once

#include "forcebound/time/clock.hpp"
#include "tests/tools/sim/draw.hpp"

namespace forcebound::sim {

using time::Nanoseconds;

/// Timing of the client's ticks.
struct TickTiming {
  double late_share = 0;                       ///< of all ticks
  Nanoseconds late_max = Nanoseconds::zero();  ///< largest lateness of these
  bool measured = false;                       ///< in addition, all are late as measured on a shared virtual machine
  Nanoseconds choosing_max = Nanoseconds::zero();  ///< largest time from the reading to the command
};

/// When the client's ticks begin, and how long they take to their command: drawn from a seed.
///
/// Like time::PeriodicTimer: nominal times are absolute, a late tick does not shift the next one, ticks missed
/// altogether are left out.
class TickSchedule {
 public:
  TickSchedule(const TickTiming& timing, Nanoseconds period, std::uint64_t seed)
      : timing_(timing), period_(period), draw_(seed) {}

  /// When the next tick wakes up, but not before `free`, the end of the one before.
  [[nodiscard]] Nanoseconds next_wake(Nanoseconds free);

  /// From a tick's reading to its command.
  [[nodiscard]] Nanoseconds next_choosing();

  /// When in that time the force was chosen: mostly just before the end, sometimes long before.
  [[nodiscard]] Nanoseconds next_chosen(Nanoseconds commanded);

 private:
  [[nodiscard]] Nanoseconds lateness();

  TickTiming timing_;
  Nanoseconds period_;
  Draw draw_;
  Nanoseconds due_{0};
};

}  // namespace forcebound::sim
