#pragma once

#include <chrono>

namespace forcebound::time {

using Nanoseconds = std::chrono::nanoseconds;

/// A steady clock with an arbitrary origin. The core never asks the operating system for time: it is given a Clock.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual Nanoseconds now() const noexcept = 0;
};

constexpr double to_seconds(Nanoseconds t) noexcept { return static_cast<double>(t.count()) * 1e-9; }

/// Rounds to the nearest nanosecond; saturates at 64 bits, so that no input is undefined behaviour.
constexpr Nanoseconds from_seconds(double seconds) noexcept {
  const double ns = seconds * 1e9;
  if (!(ns > -9.2e18)) return Nanoseconds::min();
  if (!(ns < 9.2e18)) return Nanoseconds::max();
  return Nanoseconds{static_cast<Nanoseconds::rep>(ns < 0 ? ns - 0.5 : ns + 0.5)};
}

}  // namespace forcebound::time
