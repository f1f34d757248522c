#include "forcebound/wire/version_mismatch.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

namespace forcebound::wire {

VersionMismatch::VersionMismatch(std::uint32_t server, std::uint32_t client) noexcept {
  const int written =
      std::snprintf(text_.data(), text_.size(),
                    "the server speaks protocol version %" PRIu32 ", the client version %" PRIu32 ": update the %s",
                    server, client, server < client ? "server" : "client");
  bytes_ = static_cast<std::size_t>(std::clamp(written, 0, static_cast<int>(text_.size()) - 1));
}

}  // namespace forcebound::wire
