#pragma once

#include <algorithm>
#include <cmath>

#include "forcebound/time/clock.hpp"

namespace forcebound::server {

/// How much of a processor's time the answers of one session take, and whether it may have more now.
///
/// The share is a mean over about kMean. The budget is time that a session may still use: it fills at the share that it
/// is allowed, up to kBurst of time at that share, and every answer takes from it what it took. An answer is begun
/// while something is left, however long it will take, so that a scene whose single answer takes longer than kBurst is
/// answered, only less often.
///
/// Real time: noexcept, no allocation. Not thread-safe.
class ComputeShare {
 public:
  static constexpr time::Nanoseconds kMean = std::chrono::seconds{1};
  static constexpr time::Nanoseconds kBurst = std::chrono::milliseconds{100};

  /// @param allowed share of one processor, above 0
  ComputeShare(double allowed, time::Nanoseconds now) noexcept
      : allowed_(allowed), budget_s_(most_s()), since_(now), noted_(now) {}

  /// Whether an answer may be begun.
  [[nodiscard]] bool may_answer(time::Nanoseconds now) noexcept {
    fill(now);
    return budget_s_ > 0;
  }

  /// An answer took so long, until now.
  void charge(time::Nanoseconds took, time::Nanoseconds now) noexcept {
    fill(now);
    budget_s_ -= time::to_seconds(took);
    decay(now);
    share_ += time::to_seconds(took) / time::to_seconds(kMean);
  }

  /// Of one processor, lately; a session that has just begun shows less than it will take.
  [[nodiscard]] double share(time::Nanoseconds now) noexcept {
    decay(now);
    return share_;
  }

 private:
  [[nodiscard]] double most_s() const noexcept { return allowed_ * time::to_seconds(kBurst); }

  void fill(time::Nanoseconds now) noexcept {
    budget_s_ = std::min(most_s(), budget_s_ + allowed_ * std::max(0.0, time::to_seconds(now - since_)));
    since_ = now;
  }

  void decay(time::Nanoseconds now) noexcept {
    share_ *= std::exp(-std::max(0.0, time::to_seconds(now - noted_)) / time::to_seconds(kMean));
    noted_ = now;
  }

  double allowed_;
  double budget_s_;
  double share_ = 0;
  time::Nanoseconds since_;
  time::Nanoseconds noted_;
};

}  // namespace forcebound::server
