#pragma once

#include <string>

namespace forcebound::time {

/// The real-time settings that the system granted.
struct RealTimeGrant {
  bool first_in_first_out = false;  ///< SCHED_FIFO
  bool memory_locked = false;
  bool processors_awake = false;  ///< asked for with SCHED_FIFO only: it costs power
  std::string text;               ///< what was granted, and why the rest was not
};

/// Asks for SCHED_FIFO at `priority` (1 to 99) for the calling thread. Threads that it starts later inherit that unless
/// systemd has started the process (CPUSchedulingResetOnFork, a flag that stays set): each that needs it asks for
/// itself.
/// @returns 0, or the error number of the refusal.
[[nodiscard]] int ask_for_first_in_first_out(int priority) noexcept;

/// Asks for SCHED_FIFO at `priority` (1 to 99) for the calling thread and for all memory of the process, present and
/// future, to stay in RAM; if SCHED_FIFO is granted, also for processors kept awake as long as the process lives, so
/// that waking up takes no time. A refusal is not an error: the measured wake-up jitter shows its effect.
RealTimeGrant ask_for_real_time(int priority);

/// Touches the stack of the calling thread, so that the tick does not meet a page fault there.
void touch_stack() noexcept;

}  // namespace forcebound::time
