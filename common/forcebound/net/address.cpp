#include <arpa/inet.h>

#include <algorithm>
#include <array>

#include "forcebound/net/datagram_link.hpp"

namespace forcebound::net {

std::string to_string(const Address& address) {
  constexpr std::array<std::uint8_t, 12> kMappedPrefix{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
  const auto& ip = address.ip;
  const std::string port = ":" + std::to_string(address.port);
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (std::equal(kMappedPrefix.begin(), kMappedPrefix.end(), ip.begin()))
    return inet_ntop(AF_INET, &ip[kMappedPrefix.size()], text.data(), text.size()) + port;
  return "[" + std::string(inet_ntop(AF_INET6, ip.data(), text.data(), text.size())) + "]" + port;
}

}  // namespace forcebound::net
