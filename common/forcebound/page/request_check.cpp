#include "forcebound/page/request_check.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace forcebound::page {
namespace {

/// A host as it stands in addresses: an IPv6 address in brackets.
std::string bracketed(std::string host) {
  if (host.find(':') == std::string::npos || host.starts_with('[')) return host;
  return "[" + host + "]";
}

std::string lower(std::string_view text) {
  std::string low(text);
  std::ranges::transform(low, low.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return low;
}

bool is_numeric_address(std::string_view host) {
  if (host.starts_with('[')) return host.ends_with(']');
  const auto of_ipv4 = [](char letter) { return letter == '.' || (letter >= '0' && letter <= '9'); };
  return !host.empty() && std::ranges::all_of(host, of_ipv4);
}

}  // namespace

std::string token_of(std::span<const std::byte> random) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  constexpr unsigned kHalf = 4;
  constexpr unsigned kLow = 15;
  std::string token;
  for (const std::byte byte : random) {
    token += kDigits[std::to_integer<unsigned>(byte) >> kHalf];
    token += kDigits[std::to_integer<unsigned>(byte) & kLow];
  }
  return token;
}

bool equal_in_constant_time(std::string_view one, std::string_view other) noexcept {
  if (one.size() != other.size()) return false;
  volatile unsigned char difference = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    difference = static_cast<unsigned char>(
        difference | (static_cast<unsigned char>(one[i]) ^ static_cast<unsigned char>(other[i])));
  }
  return difference == 0;
}

std::string_view path_of(std::string_view target) noexcept { return target.substr(0, target.find('?')); }

std::string_view query_value(std::string_view target, std::string_view key) noexcept {
  const std::size_t begin = target.find('?');
  if (begin == std::string_view::npos) return {};
  std::string_view query = target.substr(begin + 1);
  while (!query.empty()) {
    const std::string_view item = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), item.size() + 1));
    if (item.size() > key.size() && item.starts_with(key) && item[key.size()] == '=') {
      return item.substr(key.size() + 1);
    }
  }
  return {};
}

std::string_view bearer_token(std::string_view authorization) noexcept {
  constexpr std::string_view kBearer = "Bearer ";
  return authorization.starts_with(kBearer) ? authorization.substr(kBearer.size()) : std::string_view{};
}

HostCheck::HostCheck(std::string host, std::uint16_t port)
    : host_(lower(bracketed(std::move(host)))),
      port_(std::to_string(port)),
      everywhere_(host_ == "0.0.0.0" || host_ == "[::]") {}

bool HostCheck::accepts(std::string_view host_and_port) const {
  // Browsers leave out the port that http has by itself.
  constexpr std::string_view kStandardPort = "80";
  std::string_view host = host_and_port;
  std::string_view port = kStandardPort;
  const std::size_t colon = host_and_port.rfind(':');
  if (colon != std::string_view::npos && host_and_port.find(']', colon) == std::string_view::npos) {
    host = host_and_port.substr(0, colon);
    port = host_and_port.substr(colon + 1);
  }
  if (port != port_) return false;
  const std::string name = lower(host);
  constexpr std::array<std::string_view, 3> kLoopback{"localhost", "127.0.0.1", "[::1]"};
  if (std::ranges::find(kLoopback, name) != kLoopback.end() || name == host_) return true;
  return everywhere_ && is_numeric_address(name);
}

bool HostCheck::accepts_origin(std::string_view origin) const {
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && accepts(origin.substr(kScheme.size()));
}

}  // namespace forcebound::page
