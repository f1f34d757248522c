#pragma once

namespace forcebound::client {

/// SCHED_FIFO, of the tick and of the thread it is measured against.
inline constexpr int kTickPriority = 80;

/// Of the thread that looks whether the tick still runs, also if that never sleeps.
inline constexpr int kWatchdogPriority = 85;

}  // namespace forcebound::client
