#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/security/handshake_datagram.hpp"

namespace forcebound::server {

/// Requests that wait until there is time for them, in the order in which they came. Bounded, and of each client,
/// source and session of keys few: what finds no room is lost, and whoever asked asks again.
///
/// Real time: noexcept, allocates nothing; `put` looks at all that wait. Not thread-safe.
class WaitingHandshakes {
 public:
  static constexpr std::size_t kMost = 256;
  static constexpr std::size_t kOfOneMost = 4;

  /// A request, and for a later handshake the record that it came in.
  struct Waiting {
    security::HandshakeTopic topic{};
    security::Cookie cookie{};
    security::Proofs proofs{};
    std::array<std::byte, security::kSealedRequestBytesMost> message{};
    std::size_t message_bytes = 0;
    net::Address from{};
    std::uint64_t who = 0;     ///< whose they are, among those of whom few may wait
    bool proven = false;       ///< of a first one: by its proofs
    std::uint32_t keys = 0;    ///< the session of keys; 0: a first handshake
    std::uint8_t under = 0;    ///< the number of the handshake whose key sealed the record
    std::uint64_t record = 0;  ///< its counter under that key

    /// Valid as long as this is.
    [[nodiscard]] security::HandshakeRequest request() const noexcept {
      return {.topic = topic, .cookie = cookie, .proofs = proofs, .message = std::span(message).first(message_bytes)};
    }
  };

  /// @return whether there was room
  [[nodiscard]] bool put(const Waiting& waiting) noexcept;

  /// The oldest.
  [[nodiscard]] std::optional<Waiting> take() noexcept;

  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }

 private:
  std::array<Waiting, kMost> ring_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace forcebound::server
