#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace forcebound::server {

/// How many bytes may be answered to the address that a session's motions come from.
///
/// Anybody can write another's address into a datagram. Until the address is proven, no more bytes are sent there than
/// came from it, so that a server floods nobody. It is proven once a number that was sent there alone, the challenge,
/// comes back from it. [RFC 9000, sections 8.1 and 9.3.1; the factor there is 3, ours is 1]
///
/// Bytes are those of datagrams without their IP and UDP headings. Real time: noexcept, no allocation. Not thread-safe.
class AntiAmplificationLimit {
 public:
  /// Another address, of which nothing is known. @param challenge unguessable; 0: it cannot be proven
  void begin(std::uint64_t challenge) noexcept {
    proven_ = false;
    challenge_ = challenge;
    bytes_ = 0;
  }

  /// The address is one that was proven before, or that only the session's client can know of.
  void prove() noexcept {
    proven_ = true;
    challenge_ = 0;
  }

  /// A datagram came from there, with this challenge in it.
  void count_received(std::size_t bytes, std::uint64_t echoed) noexcept {
    if (proven_) return;
    if (echoed != 0 && echoed == challenge_) {
      prove();
      return;
    }
    bytes_ = bytes < std::numeric_limits<std::size_t>::max() - bytes_ ? bytes_ + bytes : bytes_;
  }

  /// Whether an answer of that size may be sent; if so, it counts as sent.
  [[nodiscard]] bool spend(std::size_t bytes) noexcept {
    if (proven_) return true;
    if (bytes > bytes_) return false;
    bytes_ -= bytes;
    return true;
  }

  [[nodiscard]] bool proven() const noexcept { return proven_; }

  /// To be sent there; 0: none is needed.
  [[nodiscard]] std::uint64_t challenge() const noexcept { return challenge_; }

 private:
  bool proven_ = true;
  std::uint64_t challenge_ = 0;
  std::size_t bytes_ = 0;  ///< came and not yet answered
};

}  // namespace forcebound::server
