#pragma once

#include <cstdint>

namespace forcebound::client {

/// Whether forces come, as the connection sees it: Connection says when each begins.
enum class SessionState : std::uint8_t { connecting, active, stale, reconnecting };

/// For people.
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
