#pragma once

#include <cstdint>

namespace forcebound::record {

/// State of a client's connection; client::Connection defines each state.
enum class SessionState : std::uint8_t { connecting, active, stale, reconnecting };

/// What the late-force policy, client::LateForcePolicy, did with the newest force; none: there is no force yet.
enum class ForcePolicy : std::uint8_t { none, fresh, fading, dropped };

/// The state's name for reports.
[[nodiscard]] constexpr const char* name_of(SessionState state) noexcept {
  switch (state) {
    case SessionState::connecting:
      return "connecting";
    case SessionState::active:
      return "active";
    case SessionState::stale:
      return "stale";
    case SessionState::reconnecting:
      return "reconnecting";
  }
  return "unknown";
}

}  // namespace forcebound::record
