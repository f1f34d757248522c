#pragma once

#include <cstdint>
#include <optional>

#include "forcebound/record/histogram.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::record {

/// Intervals between the wake-ups of a thread that wakes up periodically.
///
/// Real time: `add` is noexcept and allocates nothing. Not thread-safe.
class WakeUps {
 public:
  explicit WakeUps(Nanoseconds period) : period_(period) {}

  /// It woke up now.
  void add(Nanoseconds now) noexcept {
    if (previous_) {
      const Nanoseconds interval = now - *previous_;
      intervals_ns_.add(interval.count());
      late_ += interval > period_ + kLateBy ? 1U : 0U;
    }
    previous_ = now;
  }

  [[nodiscard]] IdleTimer figures() const noexcept {
    constexpr double kNs_in_us = 1e-3;
    return {.wake_ups = intervals_ns_.count(),
            .late = late_,
            .p50_us = kNs_in_us * intervals_ns_.percentile(0.5),
            .p99_us = kNs_in_us * intervals_ns_.percentile(0.99),
            .p999_us = kNs_in_us * intervals_ns_.percentile(0.999),
            .max_us = kNs_in_us * intervals_ns_.max()};
  }

 private:
  Nanoseconds period_;
  Histogram intervals_ns_;
  std::optional<Nanoseconds> previous_;
  std::uint64_t late_ = 0;
};

}  // namespace forcebound::record
