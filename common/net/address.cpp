#include <algorithm>
#include <array>
#include <cstdio>

#include "forcebound/net/datagram_link.hpp"

namespace forcebound::net {

std::string to_string(const Address& address) {
  constexpr std::array<std::uint8_t, 12> kMappedPrefix{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
  const auto& ip = address.ip;
  char text[64];
  if (std::equal(kMappedPrefix.begin(), kMappedPrefix.end(), ip.begin())) {
    std::snprintf(text, sizeof text, "%u.%u.%u.%u:%u", ip[12], ip[13], ip[14], ip[15], address.port);
    return text;
  }
  std::string result = "[";
  for (std::size_t i = 0; i < ip.size(); i += 2) {
    std::snprintf(text, sizeof text, i == 0 ? "%x" : ":%x", unsigned{ip[i]} << 8U | ip[i + 1]);
    result += text;
  }
  return result + "]:" + std::to_string(address.port);
}

}  // namespace forcebound::net
