#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "forcebound/net/udp_link.hpp"

namespace forcebound::server {

/// How the system chooses among the sockets of a server's workers, which have one address together.
///
///     a motion or Bye in the clear     the lowest byte of its session's number, modulo the workers
///     a sealed datagram                that of its receiver's number for the session of keys
///     a wake-up call                   the worker that it names
///     all else, first of all a Hello   a hash of both addresses: a client without a session, by where it is
///
/// Sessions get numbers of their worker, so that a client that moves to another address is still heard by it.

/// What the system will choose for it; nothing: the hash decides.
[[nodiscard]] std::optional<std::size_t> worker_for(std::span<const std::byte> datagram, std::size_t workers) noexcept;

/// Has the system choose so among all sockets of the group: those bound `beside` one another, in the order of that.
/// False if the system cannot do so.
[[nodiscard]] bool steer(const net::UdpLink& one_of_group, std::size_t workers) noexcept;

/// A datagram of the server to itself, which ends a worker's wait. Anybody can send one, and nothing else happens.
using WakeUpCall = std::array<std::byte, 3>;
[[nodiscard]] WakeUpCall wake_up_call(std::size_t worker) noexcept;
[[nodiscard]] bool is_wake_up_call(std::span<const std::byte> datagram) noexcept;

}  // namespace forcebound::server
