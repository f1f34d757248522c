#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "forcebound/net/udp_link.hpp"

namespace forcebound::client::commands {

/// Headers in front of a datagram's payload: IPv4 or IPv6 without options, and UDP.
[[nodiscard]] std::size_t header_bytes(const net::Address& peer) noexcept;

/// Whether the network may take a link's datagrams apart on their way.
enum class Fragments : std::uint8_t {
  as_usual,  ///< as the system has it: not, but this machine does where it knows that the path is too narrow
  never,     ///< not by this machine either: what is too large does not arrive
};
void set_fragments(const net::UdpLink& link, const net::Address& peer, Fragments fragments) noexcept;

/// The largest packet [bytes, headers included] that the system believes to get to the link's peer whole: that of the
/// interface, or what a router on the way has said since. Nothing if it does not tell.
[[nodiscard]] std::optional<std::size_t> believed_mtu(const net::UdpLink& link, const net::Address& peer) noexcept;

struct SizeRange {
  std::size_t least = 0;
  std::size_t most = 0;
};

/// The largest size that passes, by halving; less than `resolution` below the true one. The largest is tried first.
/// 0 if not even the least does.
/// @param passes tries a size, as often as the network's losses take
[[nodiscard]] std::size_t largest_that_passes(const SizeRange& range, std::size_t resolution,
                                              const std::function<bool(std::size_t)>& passes);

}  // namespace forcebound::client::commands
