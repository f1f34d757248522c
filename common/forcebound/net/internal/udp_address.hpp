#pragma once

#include <asio/ip/udp.hpp>

#include "forcebound/net/datagram_link.hpp"

struct msghdr;

/// Shared by the sockets' files: the system's form of addresses, and its control data of a datagram.
namespace forcebound::net {

[[nodiscard]] asio::ip::udp::endpoint to_asio(const Address& address) noexcept;
[[nodiscard]] Address from_asio(const asio::ip::udp::endpoint& endpoint) noexcept;

inline constexpr std::size_t kControlBytes = 128;

/// For how long a datagram was in the system's buffer, from the kernel's control data of it.
/// @param wall_clock_now now, on the clock of the kernel's stamps
[[nodiscard]] time::Nanoseconds waited_of(msghdr& message, time::Nanoseconds wall_clock_now) noexcept;

}  // namespace forcebound::net
