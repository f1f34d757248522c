#pragma once

#include "forcebound/time/clock.hpp"

namespace forcebound::time {

/// The operating system's monotonic clock. For programs; the core is given it as a Clock.
class SteadyClock final : public Clock {
 public:
  [[nodiscard]] Nanoseconds now() const noexcept override;
};

/// Wall-clock time now, since 1970 UTC: only to date recordings and logs.
[[nodiscard]] Nanoseconds wall_clock_now() noexcept;

}  // namespace forcebound::time
