#pragma once

#include "forcebound/time/clock.hpp"

namespace forcebound::test {

/// A clock that the test sets.
class FakeClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override { return time; }

  time::Nanoseconds time{0};
};

}  // namespace forcebound::test
