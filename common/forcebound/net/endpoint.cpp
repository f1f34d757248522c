#include "forcebound/net/endpoint.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>

namespace forcebound::net {
namespace {

Endpoint parse(std::string_view text, std::uint16_t least_port) {
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("'" + std::string(text) + "' " + why +
                                ": expected for example 127.0.0.1:47800, localhost:47800 or [::1]:47800, with a port "
                                "from " +
                                std::to_string(least_port) + " to 65535");
  };
  const char* const no_endpoint = "is not HOST:PORT";
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) refuse(no_endpoint);
  std::string_view host = text.substr(0, colon);
  const std::string_view port_text = text.substr(colon + 1);
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  // Without brackets, the last part of ::1 may be a port or not.
  if (host.empty() || (!bracketed && host.find_first_of(":[] \t") != std::string_view::npos)) refuse(no_endpoint);
  Endpoint endpoint{std::string(host), 0};
  const char* const end = port_text.data() + port_text.size();
  const auto [stopped, error] = std::from_chars(port_text.data(), end, endpoint.port);
  if (error != std::errc{} || stopped != end) refuse(no_endpoint);
  if (endpoint.port < least_port) refuse("cannot be sent to");
  return endpoint;
}

}  // namespace

Endpoint parse_endpoint(std::string_view text) { return parse(text, 0); }

Endpoint parse_peer(std::string_view text) { return parse(text, 1); }

std::string to_string(const Endpoint& endpoint) {
  const bool in_brackets = endpoint.host.find(':') != std::string::npos;
  return (in_brackets ? "[" + endpoint.host + "]" : endpoint.host) + ":" + std::to_string(endpoint.port);
}

bool is_numeric(const Endpoint& endpoint) noexcept {
  std::array<std::uint8_t, sizeof(in6_addr)> ignored{};
  return inet_pton(AF_INET, endpoint.host.c_str(), ignored.data()) == 1 ||
         inet_pton(AF_INET6, endpoint.host.c_str(), ignored.data()) == 1;
}

std::vector<Address> in_order_of_trial(const std::vector<Address>& addresses) {
  std::array<std::vector<Address>, 2> families;  // IPv6, IPv4
  for (const Address& address : addresses) {
    std::vector<Address>& same = families[is_ipv4(address) ? 1 : 0];
    if (std::ranges::find(same, address) == same.end()) same.push_back(address);
  }
  std::vector<Address> order;
  for (std::size_t i = 0; i < std::max(families[0].size(), families[1].size()); ++i) {
    for (const std::vector<Address>& family : families) {
      if (i < family.size()) order.push_back(family[i]);
    }
  }
  return order;
}

Address resolve(const Endpoint& endpoint) {
  const std::vector<Address> found = look_up(endpoint);
  const auto v4 = std::ranges::find_if(found, is_ipv4);
  return v4 == found.end() ? found.front() : *v4;
}

}  // namespace forcebound::net
