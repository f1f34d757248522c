#pragma once

#include <stdexcept>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/udp_link.hpp"

namespace forcebound::test {

[[nodiscard]] inline bool machine_has_ipv6() {
  try {
    net::UdpLink::listen(net::resolve({"::1", 0}));
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

}  // namespace forcebound::test
