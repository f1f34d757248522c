#pragma once

#include <utility>
#include <vector>

#include "forcebound/time/clock.hpp"

namespace forcebound::sim {

using time::Nanoseconds;

/// Difference of another machine's clock from the true one.
struct ClockSkew {
  struct Jump {
    Nanoseconds at;
    Nanoseconds by;
  };
  Nanoseconds offset{0};
  double rate_error = 0;  ///< 1e-4: gains 0.1 ms each second
  std::vector<Jump> jumps{};
};

/// Another machine's clock: with an offset, a rate error and jumps.
class SkewedClock final : public time::Clock {
 public:
  SkewedClock(const time::Clock& truth, ClockSkew skew) : truth_(truth), skew_(std::move(skew)) {}

  [[nodiscard]] Nanoseconds now() const noexcept override { return shown_at(truth_.now()); }

  /// Its reading at a true time.
  [[nodiscard]] Nanoseconds shown_at(Nanoseconds time) const noexcept {
    Nanoseconds shown = time + skew_.offset + time::from_seconds(skew_.rate_error * time::to_seconds(time));
    for (const ClockSkew::Jump& jump : skew_.jumps) {
      if (time >= jump.at) shown += jump.by;
    }
    return shown;
  }

 private:
  const time::Clock& truth_;
  ClockSkew skew_;
};

}  // namespace forcebound::sim
