#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "forcebound/time/clock.hpp"

namespace forcebound::net {

/// Length of a buffer for one datagram: more than the protocol's longest (wire::kFrameBytesMax), so that a longer one
/// is recognised, and little enough for an Ethernet frame, so that nothing sent from it is fragmented.
inline constexpr std::size_t kDatagramBytesMax = 1400;

/// A UDP endpoint as a value: IPv6, or IPv4 mapped into it. A simulated network uses any distinct values.
struct Address {
  std::array<std::uint8_t, 16> ip{};
  std::uint16_t port = 0;
  auto operator<=>(const Address&) const = default;
};

/// "127.0.0.1:47800" or "[::1]:47800".
std::string to_string(const Address& address);

/// Whether it is of this machine itself: ::1, or 127.0.0.0/8.
[[nodiscard]] bool is_loopback(const Address& address) noexcept;

struct Received {
  std::size_t bytes;  ///< the datagram's whole size; larger than the buffer if it was cut
  Address from;
  time::Nanoseconds waited{0};  ///< from its arrival at this machine until now
};

/// Unreliable datagrams: the core's interface to a network.
///
/// Real time: both calls return at once and allocate nothing.
class DatagramLink {
 public:
  virtual ~DatagramLink() = default;

  /// False if the system did not take the datagram; the caller counts it; there is no retry.
  virtual bool send(std::span<const std::byte> datagram, const Address& to) noexcept = 0;

  /// The oldest waiting datagram, or nothing. Oversize datagrams are cut to the buffer, `bytes` tells.
  virtual std::optional<Received> receive(std::span<std::byte> buffer) noexcept = 0;

  /// Whether a datagram can be sent at all now; until then, who begins a conversation waits.
  [[nodiscard]] virtual bool ready() const noexcept { return true; }
};

}  // namespace forcebound::net
