#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

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

/// Finds the addresses of a host; may block. Throws std::runtime_error naming the host and why it has none.
using Resolver = std::function<std::vector<Address>(const Endpoint&)>;

/// The system's resolver: in the order in which they are to be tried. Blocks, for seconds if a name server does not
/// answer.
///
/// @throws std::runtime_error naming the host and why it has no address.
std::vector<Address> look_up(const Endpoint& endpoint);

/// Whether it is of IPv4.
[[nodiscard]] bool is_ipv4(const Address& address) noexcept;

/// The order in which addresses are tried: IPv6 first, then the families by turns, those of a family in the order
/// given, and none twice [RFC 8305, section 4, with a first address family count of one].
std::vector<Address> in_order_of_trial(const std::vector<Address>& addresses);

/// An address to listen at: the host's first; if it has addresses of both kinds, the first of IPv4. Blocks as `look_up`
/// does.
///
/// @throws std::runtime_error naming the host and why it has no address.
Address resolve(const Endpoint& endpoint);

/// "HOST:PORT", as `parse_endpoint` reads it.
std::string to_string(const Endpoint& endpoint);

/// Whether the host is an address in digits, for which nobody needs to be asked.
[[nodiscard]] bool is_numeric(const Endpoint& endpoint) noexcept;

}  // namespace forcebound::net
