#pragma once

#include <algorithm>

#include "forcebound/time/clock.hpp"

namespace forcebound::time {

/// Lets through one event per `interval` on average, and up to `burst` at once.
///
/// Real time: noexcept, no allocation.
class TokenBucket {
 public:
  TokenBucket(Nanoseconds interval, int burst, Nanoseconds now) noexcept
      : interval_(interval), most_(interval * burst), credit_(most_), last_(now) {}

  [[nodiscard]] bool take(Nanoseconds now) noexcept {
    // A clock that stands still or runs backwards adds no tokens.
    const Nanoseconds elapsed = std::clamp(now - last_, Nanoseconds{0}, most_);
    credit_ = std::min(most_, credit_ + elapsed);
    last_ = now;
    if (credit_ < interval_) return false;
    credit_ -= interval_;
    return true;
  }

 private:
  Nanoseconds interval_;
  Nanoseconds most_;
  Nanoseconds credit_;
  Nanoseconds last_;
};

}  // namespace forcebound::time
