#pragma once

#include <algorithm>

#include "forcebound/time/clock.hpp"

namespace forcebound::device {

using time::Nanoseconds;

/// Estimates how long choosing and commanding a force will take on this tick, from the latest ticks.
///
/// A law reserves energy for as long as the previous force stays in effect, so the estimate must not be far too long. A
/// force commanded later than estimated is bounded again, possibly to zero, so the estimate must rarely be too short.
/// It is 1.5 times the longest recent time, which decays by 5 % a tick, and at most half a period: a machine that is
/// always slow still shows forces, and one long tick reduces the forces for some ticks only.
///
/// Real time: noexcept, O(1).
class ChoosingTime {
 public:
  explicit ChoosingTime(Nanoseconds period) noexcept : most_(std::max(kLeast, period / 2)) {}

  void add(Nanoseconds took) noexcept { longest_ = std::max(std::min(took, most_), longest_ - longest_ / 20); }

  [[nodiscard]] Nanoseconds allowed() const noexcept { return std::clamp(longest_ + longest_ / 2, kLeast, most_); }

 private:
  static constexpr Nanoseconds kLeast = std::chrono::microseconds{20};

  Nanoseconds most_;
  Nanoseconds longest_{0};
};

}  // namespace forcebound::device
