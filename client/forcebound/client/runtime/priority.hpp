#pragma once

namespace forcebound::client {

/// SCHED_FIFO, of the tick and of the thread it is measured against.
inline constexpr int kTickPriority = 80;

}  // namespace forcebound::client
