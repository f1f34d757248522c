#include "forcebound/net/endpoint.hpp"

#include <charconv>
#include <stdexcept>

namespace forcebound::net {
namespace {

[[noreturn]] void refuse(std::string_view text) {
  throw std::invalid_argument(
      "'" + std::string(text) +
      "' is not HOST:PORT: expected for example 127.0.0.1:47800, localhost:47800 or [::1]:47800, "
      "with a port from 0 to 65535");
}

}  // namespace

Endpoint parse_endpoint(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) refuse(text);
  std::string_view host = text.substr(0, colon);
  const std::string_view port_text = text.substr(colon + 1);
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  // Without brackets, the last part of ::1 may be a port or not.
  if (host.empty() || (!bracketed && host.find_first_of(":[] \t") != std::string_view::npos)) refuse(text);
  Endpoint endpoint{std::string(host), 0};
  const char* const end = port_text.data() + port_text.size();
  const auto [stopped, error] = std::from_chars(port_text.data(), end, endpoint.port);
  if (error != std::errc{} || stopped != end) refuse(text);
  return endpoint;
}

Endpoint parse_peer(std::string_view text) {
  Endpoint endpoint = parse_endpoint(text);
  if (endpoint.port == 0) {
    throw std::invalid_argument("'" + std::string(text) + "' cannot be sent to: expected a port from 1 to 65535");
  }
  return endpoint;
}

}  // namespace forcebound::net
