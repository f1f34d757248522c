#pragma once

#include <chrono>
#include <optional>

#include "forcebound/control/reading_status.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::driver {

using time::Nanoseconds;

/// When readings were latched, as a driver says, checked: such times never run backwards and are not in the future.
class ReadingTimes {
 public:
  /// `now` was read before the encoders were: by so much at most. Who has a clock looks closer
  /// (device::usable_or_lost); this is lest one stamp that is far off makes all that follow run backwards.
  static constexpr Nanoseconds kAhead = std::chrono::milliseconds{1};

  /// @return ok: it is newer than all before
  [[nodiscard]] control::ReadingStatus judge(Nanoseconds latched, Nanoseconds now) const noexcept {
    if (newest_ && latched < *newest_) return control::ReadingStatus::backwards;
    if (latched > now + kAhead) return control::ReadingStatus::future;
    return newest_ && latched == *newest_ ? control::ReadingStatus::stale : control::ReadingStatus::ok;
  }
  void accept(Nanoseconds latched) noexcept { newest_ = latched; }

  /// Of what was accepted.
  [[nodiscard]] std::optional<Nanoseconds> newest() const noexcept { return newest_; }

 private:
  std::optional<Nanoseconds> newest_;
};

}  // namespace forcebound::driver
