#pragma once

#include <chrono>
#include <optional>
#include <string_view>

#include "forcebound/time/clock.hpp"

namespace forcebound::driver {

using time::Nanoseconds;

/// When readings were latched, as a driver says, checked: such times never run backwards and are not in the future.
class ReadingTimes {
 public:
  enum class Verdict { newer, same, backwards, future };

  /// `now` was read before the encoders were: by so much at most.
  static constexpr Nanoseconds kAhead = std::chrono::milliseconds{1};

  [[nodiscard]] Verdict judge(Nanoseconds latched, Nanoseconds now) const noexcept {
    if (newest_ && latched < *newest_) return Verdict::backwards;
    if (latched > now + kAhead) return Verdict::future;
    return newest_ && latched == *newest_ ? Verdict::same : Verdict::newer;
  }
  void accept(Nanoseconds latched) noexcept { newest_ = latched; }

  /// Of what was accepted.
  [[nodiscard]] std::optional<Nanoseconds> newest() const noexcept { return newest_; }

  [[nodiscard]] static std::string_view in_words(Verdict verdict) noexcept {
    return verdict == Verdict::backwards ? "its readings run backwards in time"
                                         : "its reading was latched in the future";
  }

 private:
  std::optional<Nanoseconds> newest_;
};

}  // namespace forcebound::driver
