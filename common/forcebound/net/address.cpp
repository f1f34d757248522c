#include <arpa/inet.h>

#include <algorithm>
#include <array>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/net/endpoint.hpp"

namespace forcebound::net {

namespace {

constexpr std::array<std::uint8_t, 12> kMappedPrefix{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};

}  // namespace

bool is_ipv4(const Address& address) noexcept {
  return std::equal(kMappedPrefix.begin(), kMappedPrefix.end(), address.ip.begin());
}

bool is_loopback(const Address& address) noexcept {
  constexpr std::array<std::uint8_t, 16> kLoopback{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
  constexpr std::uint8_t kLoopbackNetwork = 127;
  return is_ipv4(address) ? address.ip[kMappedPrefix.size()] == kLoopbackNetwork : address.ip == kLoopback;
}

std::string to_string(const Address& address) {
  const auto& ip = address.ip;
  const std::string port = ":" + std::to_string(address.port);
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (is_ipv4(address)) return inet_ntop(AF_INET, &ip[kMappedPrefix.size()], text.data(), text.size()) + port;
  return "[" + std::string(inet_ntop(AF_INET6, ip.data(), text.data(), text.size())) + "]" + port;
}

}  // namespace forcebound::net
