#pragma once

#include <algorithm>
#include <cstdint>

#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// How far the server's clock is ahead of the device's, and how sure that is.
///
/// A motion read at t_1 of the device's clock arrived at t_2 of the server's; its answer left at t_3 and arrived at
/// t_4. Neither way takes less than no time, so that the offset o of the clocks lies within
///
///     t_3 - t_4 <= o <= t_2 - t_1        [the intervals of Marzullo and Owicki 1983]
///
/// and within what each earlier answer said, widened by the most that two clocks drift apart in the time since. What is
/// left of it comes from the least delay of each way. Times alone do not tell which way takes longer: the middle of the
/// interval is the guess, and half of its width, about half of the least round trip, is how far that may be off.
///
/// Where no offset is within all of this, a clock was set or is another one, and it begins anew.
///
/// Real time: noexcept, O(1).
class ClockOffset {
 public:
  /// Between a crystal that is 100 ppm too fast and one that is as much too slow.
  static constexpr std::int64_t kDrift_ppm = 200;

  struct Exchange {
    Nanoseconds read{0};      ///< t_1
    Nanoseconds received{0};  ///< t_2, the server's clock
    Nanoseconds answered{0};  ///< t_3, the server's clock
    Nanoseconds arrived{0};   ///< t_4
  };

  /// An answer came. What it says may be anything.
  void update(const Exchange& answer) noexcept {
    if (!is_within_reach(answer)) return;
    const Nanoseconds least = answer.answered - answer.arrived;
    const Nanoseconds most = answer.received - answer.read;
    if (least > most) return;
    const Nanoseconds drift = drift_since(answer.arrived);
    const Nanoseconds from = std::max(least, least_ - drift);
    const Nanoseconds to = std::min(most, most_ + drift);
    const bool begins = !known_ || from > to;
    least_ = begins ? least : from;
    most_ = begins ? most : to;
    updated_ = known_ ? std::max(updated_, answer.arrived) : answer.arrived;
    known_ = true;
  }

  /// Another server, or one that has started anew.
  void forget() noexcept { *this = {}; }

  [[nodiscard]] bool known() const noexcept { return known_; }

  /// The server's time less the device's, most likely. Zero as long as it is not known.
  [[nodiscard]] Nanoseconds ahead() const noexcept { return least_ + (most_ - least_) / 2; }

  /// It may be that much more or less; anything, as long as it is not known. @param now of the device's clock
  [[nodiscard]] Nanoseconds uncertainty(Nanoseconds now) const noexcept {
    return known_ ? (most_ - least_) / 2 + drift_since(now) : Nanoseconds::max();
  }

  /// A time of the server's clock by the device's.
  [[nodiscard]] Nanoseconds by_device(Nanoseconds server_time) const noexcept {
    return std::clamp(server_time, -kFarthest, kFarthest) - ahead();
  }

 private:
  static constexpr Nanoseconds kFarthest = std::chrono::hours{24 * 365 * 50};

  /// Differences of such times, and a drift beside them, can be computed with.
  [[nodiscard]] static bool is_within_reach(const Exchange& answer) noexcept {
    for (const Nanoseconds time : {answer.read, answer.received, answer.answered, answer.arrived}) {
      if (time > kFarthest || time < -kFarthest) return false;
    }
    return true;
  }

  [[nodiscard]] Nanoseconds drift_since(Nanoseconds now) const noexcept {
    return known_ && now > updated_ ? (now - updated_) / 1'000'000 * kDrift_ppm : Nanoseconds::zero();
  }

  Nanoseconds least_{0};
  Nanoseconds most_{0};
  Nanoseconds updated_{0};  // when the newest answer came
  bool known_ = false;
};

}  // namespace forcebound::client
