#pragma once

#include <chrono>
#include <optional>
#include <string_view>

#include "forcebound/control/follower_state.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using control::FollowerState;
using time::Nanoseconds;

/// After which times of silence a robot does what.
struct EngagementTimes {
  Nanoseconds hold{std::chrono::milliseconds{100}};   ///< silent for longer: it holds its place
  Nanoseconds stop{std::chrono::milliseconds{500}};   ///< silent for longer: it is brought to rest
  Nanoseconds still{std::chrono::milliseconds{300}};  ///< a leader without buttons engages by being at rest for so long
};

/// When a robot follows its leader: the state machine, whose states are FollowerState.
///
///     waiting --engage--> following <--release/press--> clutched
///                           |   ^
///                    silent |   | heard again
///                           v   |
///                          holding --silent for longer--> stopping --at rest--> stopped --engage--> following
///     any of them --limit exceeded or robot refuses--> stopping or failed
///
/// *Engage* takes both ends: the robot is ready, and the operator says so: by pressing and releasing the clutch, or, of
/// a device without buttons, by keeping it still for `still`; after a stop, by moving it before: a device that nobody
/// holds, or that is still pressed against what stopped the robot, engages nothing. Whenever the robot begins to follow
/// (`begins`), the offset between device and tool is taken anew, so that nothing jumps.
///
/// Real time: noexcept, no allocation.
class Engagement {
 public:
  explicit Engagement(const EngagementTimes& times) noexcept : times_(times) {}

  /// As of one tick of the robot.
  struct Sample {
    Nanoseconds now{0};
    std::optional<Nanoseconds> silent;  ///< since the leader was last heard; none: nobody leads
    bool has_buttons = false;           ///< of the leader
    bool clutch_pressed = false;
    bool leader_still = false;
    bool robot_ready = true;  ///< it answers and takes commands
    bool robot_at_rest = false;
    bool robot_stopped = false;   ///< its brakes hold, whoever asked for it
    bool reading_usable = true;   ///< where it is, is known: else it cannot begin to follow
    std::string_view exceeded{};  ///< limit of force, speed or place, in a few words; empty: none. Static text
  };

  FollowerState update(const Sample& sample) noexcept;

  [[nodiscard]] FollowerState state() const noexcept { return state_; }

  /// The latest update went over to `following`: take the offset anew.
  [[nodiscard]] bool begins() const noexcept { return begins_; }

  /// Why it stopped last; empty: it did not.
  [[nodiscard]] std::string_view why_stopped() const noexcept { return why_; }

 private:
  [[nodiscard]] FollowerState next(const Sample& sample) noexcept;
  [[nodiscard]] bool operator_engages(const Sample& sample) noexcept;

  EngagementTimes times_;
  FollowerState state_ = FollowerState::waiting;
  bool begins_ = false;
  bool was_pressed_ = false;
  std::optional<Nanoseconds> still_since_;
  bool moved_ = true;  // by the operator, since the last stop
  std::string_view why_;
};

}  // namespace forcebound::server
