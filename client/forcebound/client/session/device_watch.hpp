#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// Finds when a device does not answer any more, and when it does again: no usable reading for longer than `kPatience`,
/// which a reading or two that are late do not take.
///
/// Real time: noexcept, no allocation, O(1).
class DeviceWatch {
 public:
  static constexpr Nanoseconds kPatience = std::chrono::milliseconds{20};
  enum class Change : std::uint8_t { none, gone, back };

  /// Called on each tick. @param usable whether there was such a reading
  Change note(bool usable, Nanoseconds now) noexcept {
    if (usable) {
      const bool back = gone_;
      last_ = now;
      if (back) pause_ = now - since_;
      gone_ = false;
      return back ? Change::back : Change::none;
    }
    if (!last_) last_ = now;
    if (gone_ || now - *last_ <= kPatience) return Change::none;
    gone_ = true;
    since_ = *last_;
    return Change::gone;
  }

  /// The time without a usable reading, when it was back the last time.
  [[nodiscard]] Nanoseconds pause() const noexcept { return pause_; }

 private:
  std::optional<Nanoseconds> last_{};  ///< usable reading, or the first tick
  Nanoseconds since_{0};
  Nanoseconds pause_{0};
  bool gone_ = false;
};

}  // namespace forcebound::client
