#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "forcebound/net/datagram_link.hpp"

namespace forcebound::server {

/// What one may do who has shown who it is. The default is of anybody: whatever the server offers.
struct ClientRights {
  std::string_view name{};                    ///< of the client, for people
  std::string_view key{};                     ///< of the client alone, whoever has its name; empty: it is not known
  std::span<const std::string> scenes{};      ///< by name; empty: all that the server offers
  std::optional<double> motions_per_s_max{};  ///< answered; nothing: the server's own limit
  std::optional<std::size_t> sessions_max{};  ///< at once; nothing: a fair share (shared_limits.hpp)

  [[nodiscard]] bool may_use(std::string_view scene) const noexcept {
    return scenes.empty() || std::ranges::find(scenes, scene) != scenes.end();
  }
};

/// Who sent a datagram.
struct Sender {
  net::Address address;
  ClientRights rights{};
  bool judged = false;  ///< another worker has counted its Hello, and found it within its rate
};

}  // namespace forcebound::server
