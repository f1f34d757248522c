#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "forcebound/page/assets.hpp"

namespace forcebound::page {

/// Beats of `Subject` per second.
inline constexpr int kBeatsPerSecond = 60;

/// What viewers, and others who connect, may take.
struct Limits {
  std::size_t viewers = 4;
  std::size_t connections =
      128;  ///< at once, of requests that are not answered yet; then the oldest without token ends
  std::size_t connections_per_beat = 32;  ///< more wait
  std::size_t header_bytes = 8192;
  std::chrono::seconds request{5};     ///< until a request is there, and again until its answer is sent
  std::size_t message_bytes = 4096;    ///< of a viewer
  std::size_t messages_per_beat = 4;   ///< of each viewer; more wait unread, so that the sender waits too
  std::size_t messages_at_once = 240;  ///< after a pause
  std::size_t stream_bytes = std::size_t{256} << 10U;  ///< waiting for a viewer: beyond, Worth::stream is left out
  std::size_t needed_bytes = std::size_t{16} << 20U;   ///< likewise: beyond, it is disconnected
  std::chrono::seconds stalled{10};                    ///< so long a viewer may take nothing of what waits for it
};

/// Where a page is served, for whom, and what they may take.
struct PageSettings {
  std::string host{"127.0.0.1"};
  std::uint16_t port = 0;  ///< 0: a free one
  std::string token;       ///< of 32 hexadecimal digits, see token_of
  Assets assets{};
  Limits limits{};
};

}  // namespace forcebound::page
