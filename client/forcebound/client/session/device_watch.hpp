#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// Finds when a device does not answer any more, and when it does again: no usable reading for longer than `kPatience`,
/// which a reading or two that are late do not take. Where it was back less than `kAgain` before, only a pause of that
/// length is told, so that a device with a loose plug does not fill the log.
///
/// Real time: noexcept, no allocation, O(1).
class DeviceWatch {
 public:
  static constexpr Nanoseconds kPatience = std::chrono::milliseconds{20};
  static constexpr Nanoseconds kAgain = std::chrono::seconds{1};
  enum class Change : std::uint8_t { none, gone, back };

  /// Called on each tick. @param usable whether there was such a reading
  Change change_on(bool usable, Nanoseconds now) noexcept {
    if (usable) {
      const bool back = gone_;
      last_ = now;
      if (back) {
        pause_ = now - since_;
        back_ = now;
      }
      gone_ = false;
      return back ? Change::back : Change::none;
    }
    if (!last_) last_ = now;
    const bool again = back_ && *last_ - *back_ < kAgain;
    if (gone_ || now - *last_ <= (again ? kAgain : kPatience)) return Change::none;
    gone_ = true;
    since_ = *last_;
    return Change::gone;
  }

  /// The time without a usable reading, when it was back the last time.
  [[nodiscard]] Nanoseconds pause() const noexcept { return pause_; }

 private:
  std::optional<Nanoseconds> last_{};  ///< usable reading, or the first tick
  std::optional<Nanoseconds> back_{};  ///< when it was so the last time
  Nanoseconds since_{0};
  Nanoseconds pause_{0};
  bool gone_ = false;
};

}  // namespace forcebound::client
