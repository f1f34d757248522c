#pragma once

#include "forcebound/time/clock.hpp"

namespace forcebound::sim {

using time::Nanoseconds;

/// A clock that stands until it is set.
class VirtualClock final : public time::Clock {
 public:
  explicit VirtualClock(Nanoseconds start = Nanoseconds{0}) noexcept : now_(start) {}

  [[nodiscard]] Nanoseconds now() const noexcept override { return now_; }
  void set(Nanoseconds now) noexcept { now_ = now; }
  void advance(Nanoseconds by) noexcept { now_ += by; }

 private:
  Nanoseconds now_;
};

/// The client's view of the clock within a tick: time goes on while a force is chosen.
///
/// Session asks twice: before it chooses, and when it commands.
class TickClock final : public time::Clock {
 public:
  explicit TickClock(const time::Clock& truth) : truth_(truth) {}

  [[nodiscard]] Nanoseconds now() const noexcept override {
    return truth_.now() + (asked_++ == 0 ? chosen_ : commanded_);
  }

  /// For the tick that begins now: the times until it has chosen and commanded.
  void begin_tick(Nanoseconds chosen, Nanoseconds commanded) noexcept {
    chosen_ = chosen;
    commanded_ = commanded;
    asked_ = 0;
  }

 private:
  const time::Clock& truth_;
  Nanoseconds chosen_{0};
  Nanoseconds commanded_{0};
  mutable int asked_ = 0;
};

}  // namespace forcebound::sim
