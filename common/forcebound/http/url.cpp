#include <algorithm>
#include <cctype>
#include <cstdint>
#include <stdexcept>

#include "forcebound/http/client.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::http {
namespace {

constexpr std::string_view kPlain = "http://";
constexpr std::string_view kEncrypted = "https://";

std::invalid_argument wrong(std::string_view text, const std::string& why) {
  return std::invalid_argument("'" + std::string(text) + "' is no URL: " + why +
                               "; accepted is http://HOST[:PORT][/PATH] or https://HOST[:PORT][/PATH]");
}

bool is_port(const std::string& text) {
  const auto number = text::whole_number<std::uint16_t>(text);
  return number && *number > 0;
}

}  // namespace

std::string Url::authority() const {
  const bool in_brackets = host.find(':') != std::string::npos;
  return (in_brackets ? "[" + host + "]" : host) + ":" + port;
}

std::string Url::text() const { return std::string(encrypted ? kEncrypted : kPlain) + authority() + target; }

Url parse_url(std::string_view text) {
  Url url;
  std::string_view rest = text;
  if (rest.starts_with(kPlain)) {
    rest.remove_prefix(kPlain.size());
  } else if (rest.starts_with(kEncrypted)) {
    rest.remove_prefix(kEncrypted.size());
    url.encrypted = true;
  } else {
    throw wrong(text, "it begins with neither http:// nor https://");
  }
  // They would change the request's own lines.
  const auto breaks = [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0 || c == ' '; };
  if (std::ranges::any_of(rest, breaks)) throw wrong(text, "it has a space or a control character");
  const std::size_t slash = rest.find('/');
  if (slash != std::string_view::npos) {
    url.target = rest.substr(slash);
    rest = rest.substr(0, slash);
  }
  url.port = url.encrypted ? "443" : "80";
  if (rest.starts_with('[')) {
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos) throw wrong(text, "its bracket is not closed");
    url.host = rest.substr(1, end - 1);
    rest.remove_prefix(end + 1);
  } else {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    url.host = rest.substr(0, end);
    rest.remove_prefix(end);
  }
  if (rest.starts_with(':')) {
    url.port = rest.substr(1);
    rest = {};
  }
  if (url.host.empty() || url.host.find('@') != std::string::npos || !rest.empty()) throw wrong(text, "it has no host");
  if (!is_port(url.port)) throw wrong(text, "the port must be a number from 1 to 65535, got '" + url.port + "'");
  return url;
}

}  // namespace forcebound::http
