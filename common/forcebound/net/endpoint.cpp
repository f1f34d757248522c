#include "forcebound/net/endpoint.hpp"

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

}  // namespace forcebound::net
