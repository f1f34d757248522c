#pragma once

#include <algorithm>
#include <string>

#include "forcebound/time/clock.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// How often motions are sent, as it was asked for.
struct SendRate {
  double most_Hz = 0;      ///< 0: on each tick
  bool as_needed = false;  ///< as rarely as what runs at the client allows

  /// From one motion to the next, as it was asked for. Zero: each tick has one, however late it is.
  [[nodiscard]] Nanoseconds interval(Nanoseconds period) const noexcept {
    const bool each_tick = !(most_Hz > 0) || most_Hz * time::to_seconds(period) >= 1 - 1e-9;
    return each_tick ? Nanoseconds::zero() : time::from_seconds(1 / most_Hz);
  }
};

/// From "auto" or motions per second.
/// @throws std::invalid_argument below 10 a second: an answer to each motion tells that the server is there, and a path
/// is followed over gaps of up to 0.1 s
[[nodiscard]] SendRate parse_send_rate(const std::string& typed);

/// What the force of a tick needs of the server.
struct ServerNeed {
  wire::ServerParts server_parts =
      wire::ServerParts::held;  ///< beside the scene that was handed over; held as well where a model lacks
  bool scene_runs = false;      ///< at the client, or none was handed over
  bool pieces_wanted = false;
  double radius_m = 0;  ///< least radius of the local models in use; infinite: there is none
  double speed_m_per_s = 0;
  Nanoseconds hold = Nanoseconds::max();  ///< from this age on, an answer fades
  Nanoseconds round_trip{0};              ///< of the newest answer: its age when it came
};

/// The longest time between motions for which answers stay fresher than the hold time. The newest one gets as old as
/// the round trip and the time between two answers; half of what is left for that, so that one may be lost. Where a
/// round trip leaves less than a fifth of the hold time no rate keeps answers fresh: then it is a tenth of that.
///
/// Real time: noexcept.
[[nodiscard]] inline Nanoseconds fresh_interval(Nanoseconds hold, Nanoseconds round_trip) noexcept {
  return std::max(hold - std::clamp(round_trip, Nanoseconds::zero(), hold), hold / 5) / 2;
}

/// Time from one motion to the next that what is rendered at the client allows. Zero: each tick has one, since a force
/// that is held is for the place in a motion.
///
/// A scene that is all there is needs motions for the session's sake; pieces of it come in return for motions. Local
/// models are to be told anew before the device has gone a quarter of the least of their radii. No answer is to get
/// older than the hold time: a part that drives the device would fade, and the session pass for silent.
///
/// Real time: noexcept.
[[nodiscard]] inline Nanoseconds motion_interval(const ServerNeed& need) noexcept {
  constexpr double kAlone_s = 0.05;
  constexpr double kModelled_s = 0.01;
  constexpr double kPieces_s = 0.005;
  constexpr double kOfRadius = 0.25;
  if (need.server_parts == wire::ServerParts::held || !need.scene_runs) return Nanoseconds::zero();
  double interval_s = need.server_parts == wire::ServerParts::none ? kAlone_s : kModelled_s;
  if (need.pieces_wanted) interval_s = std::min(interval_s, kPieces_s);
  const bool leaves = kOfRadius * need.radius_m < interval_s * need.speed_m_per_s;
  if (leaves) interval_s = kOfRadius * need.radius_m / need.speed_m_per_s;
  return std::min(time::from_seconds(interval_s), fresh_interval(need.hold, need.round_trip));
}

/// Decides on which ticks a motion is sent.
///
/// Real time: noexcept.
class MotionSchedule {
 public:
  MotionSchedule(const SendRate& rate, Nanoseconds period) noexcept
      : as_needed_(rate.as_needed), period_(period), interval_(rate.interval(period)) {}

  /// What the last tick's force needed.
  void plan(const ServerNeed& need) noexcept {
    if (as_needed_) interval_ = motion_interval(need);
  }

  /// The next tick sends one, whatever was planned.
  void send_at_once() noexcept { began_ = false; }

  /// Whether this tick sends one: that nearest to when it is planned. Where the interval is no multiple of the period,
  /// it is kept in the mean.
  [[nodiscard]] bool is_due(Nanoseconds now) noexcept {
    const Nanoseconds planned = last_ + interval_;
    const bool clock_went_back = now + period_ < last_;
    if (began_ && !clock_went_back && now + period_ / 2 < planned) return false;
    const bool in_time = began_ && now - planned < period_ && planned - now < period_;
    last_ = in_time ? planned : now;
    began_ = true;
    return true;
  }

 private:
  bool as_needed_;
  Nanoseconds period_;
  Nanoseconds interval_;
  Nanoseconds last_{0};  // when the last one was planned; up to half a period from when it was sent
  bool began_ = false;
};

}  // namespace forcebound::client
