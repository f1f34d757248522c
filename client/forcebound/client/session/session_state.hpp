#pragma once

#include <cstdint>

namespace forcebound::client {

/// State of the connection; Connection defines each state.
enum class SessionState : std::uint8_t { connecting, active, stale, reconnecting };

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

}  // namespace forcebound::client
