#pragma once

#include <algorithm>

#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// How long choosing a force and commanding it may take this time, judged by how long it took lately.
///
/// A law reserves energy for as long as the previous force stays in effect, so the guess is to be close; a force that
/// is commanded later than guessed is asked about again, and may have to become zero, so it is to be rarely too short.
/// Half as much again as the longest of late, forgotten by 5 % a tick, and never above half a period: a machine that is
/// slow all the time shows forces, and one that stumbles once shows softer ones for some ticks.
///
/// Real time: noexcept, O(1).
class ChoosingTime {
 public:
  explicit ChoosingTime(Nanoseconds period) noexcept : most_(std::max(kLeast, period / 2)) {}

  void note(Nanoseconds took) noexcept { longest_ = std::max(std::min(took, most_), longest_ - longest_ / 20); }

  [[nodiscard]] Nanoseconds allowed() const noexcept { return std::clamp(longest_ + longest_ / 2, kLeast, most_); }

 private:
  static constexpr Nanoseconds kLeast = std::chrono::microseconds{20};

  Nanoseconds most_;
  Nanoseconds longest_{0};
};

}  // namespace forcebound::client
