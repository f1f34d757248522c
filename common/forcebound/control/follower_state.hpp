#pragma once

#include <cstdint>
#include <string_view>

namespace forcebound::control {

/// What a robot that follows a device does now. The numbers travel: they stay.
enum class FollowerState : std::uint8_t {
  none,       ///< there is no robot at the far end
  waiting,    ///< holds still: nobody leads it yet
  following,  ///< its tool moves with the device
  clutched,   ///< holds still while the operator moves the device elsewhere
  holding,    ///< holds still: the leader is silent
  stopping,   ///< is brought to rest, as the leader was silent for too long or a limit was exceeded
  stopped,    ///< at rest; follows again once the operator has engaged anew
  failed,     ///< refuses: see the reason at the server
  taken,      ///< led by another device, which took it while this one was silent
};
inline constexpr std::uint8_t kFollowerStates = 9;

[[nodiscard]] constexpr std::string_view name_of(FollowerState state) noexcept {
  switch (state) {
    case FollowerState::none:
      return "none";
    case FollowerState::waiting:
      return "waiting";
    case FollowerState::following:
      return "following";
    case FollowerState::clutched:
      return "clutched";
    case FollowerState::holding:
      return "holding";
    case FollowerState::stopping:
      return "stopping";
    case FollowerState::stopped:
      return "stopped";
    case FollowerState::failed:
      return "failed";
    case FollowerState::taken:
      return "taken";
  }
  return "none";
}

/// Of a number that came: unknown ones are `failed`, so that nobody takes them for a robot at work.
[[nodiscard]] constexpr FollowerState follower_state_of(std::uint32_t number) noexcept {
  return number < kFollowerStates ? static_cast<FollowerState>(number) : FollowerState::failed;
}

}  // namespace forcebound::control
