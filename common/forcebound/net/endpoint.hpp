#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "forcebound/net/datagram_link.hpp"

namespace forcebound::net {

/// A host and a port, as written by a user.
struct Endpoint {
  std::string host;  ///< a name, 127.0.0.1 or ::1
  std::uint16_t port = 0;
  bool operator==(const Endpoint&) const = default;
};

/// Reads HOST:PORT: "localhost:47800", "127.0.0.1:47800", "[::1]:47800".
///
/// @throws std::invalid_argument naming the text and what would be accepted.
Endpoint parse_endpoint(std::string_view text);

/// The same for an address to send to: port 0 is refused.
///
/// @throws std::invalid_argument naming the text and what would be accepted.
Endpoint parse_peer(std::string_view text);

/// Looks a host up; if it has addresses of both kinds, takes IPv4. Blocks, for seconds if a name server does not
/// answer.
///
/// @throws std::runtime_error naming the host and why it has no address.
Address resolve(const Endpoint& endpoint);

}  // namespace forcebound::net
