#pragma once

#include <cstdint>
#include <vector>

#include "forcebound/client/commands/doctor/sleep_states.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/time/real_time.hpp"

namespace forcebound::client::commands {

/// No limit, of a resource.
inline constexpr std::uint64_t kUnlimited = ~std::uint64_t{0};

/// What this machine lets a tick have, and what came of it.
struct MachineFindings {
  std::vector<SleepState> sleep_states{};
  bool can_keep_awake = false;       ///< /dev/cpu_dma_latency may be written
  std::uint64_t priority_limit = 0;  ///< of SCHED_FIFO, for this user (RLIMIT_RTPRIO)
  std::uint64_t memory_limit = 0;    ///< of locked memory [bytes] (RLIMIT_MEMLOCK)
  time::RealTimeGrant grant{};       ///< to the tick's thread
  record::IdleTimer tick{};          ///< intervals between the wake-ups of the thread that sent the motions
  std::uint64_t missed_ticks = 0;    ///< left out: that thread woke too late for them
  record::IdleTimer idle{};          ///< of the thread beside it that only slept

  /// Of the tick's intervals, those more than record::kLateBy above the period.
  [[nodiscard]] double late_share() const noexcept { return share_late(tick); }
  [[nodiscard]] double idle_late_share() const noexcept { return share_late(idle); }

 private:
  [[nodiscard]] static double share_late(const record::IdleTimer& timer) noexcept {
    return timer.wake_ups == 0 ? 0 : static_cast<double>(timer.late) / static_cast<double>(timer.wake_ups);
  }
};

/// All but the grant and the intervals.
[[nodiscard]] MachineFindings machine_findings();

}  // namespace forcebound::client::commands
