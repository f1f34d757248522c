#pragma once

#include "forcebound/time/clock.hpp"

namespace forcebound::sim {

using time::Nanoseconds;

/// A clock that stands until somebody sets it.
class VirtualClock final : public time::Clock {
 public:
  explicit VirtualClock(Nanoseconds start = Nanoseconds{0}) noexcept : now_(start) {}

  [[nodiscard]] Nanoseconds now() const noexcept override { return now_; }
  void set(Nanoseconds now) noexcept { now_ = now; }
  void advance(Nanoseconds by) noexcept { now_ += by; }

 private:
  Nanoseconds now_;
};

}  // namespace forcebound::sim
