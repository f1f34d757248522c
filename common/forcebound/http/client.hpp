#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace forcebound::http {

/// "https://allocator.example:443/gameserverallocation", in its parts.
struct Url {
  bool encrypted = false;
  std::string host{};
  std::string port{};
  std::string target{"/"};

  [[nodiscard]] std::string text() const;

  /// "HOST:PORT"; an IPv6 address is in brackets.
  [[nodiscard]] std::string authority() const;
};

/// Reads http://HOST[:PORT][/PATH] or https://...; an IPv6 address is in brackets.
/// @throws std::invalid_argument naming the text and what would be accepted
[[nodiscard]] Url parse_url(std::string_view text);

/// PEM files for https. Empty names: the system's authorities, and no certificate of our own.
struct Certificates {
  std::string authority{};
  std::string certificate{};
  std::string key{};
};

struct Request {
  std::string method{"GET"};
  std::string body{};  ///< JSON; empty: none
};

struct Response {
  int status = 0;
  std::string body{};
};

/// Why `ask` refuses every request: this program was built with FORCEBOUND_FLEET=OFF. Empty: it was built to ask.
[[nodiscard]] std::string_view refusal() noexcept;

/// Sends one request on a connection of its own and waits for the whole answer, whatever its status.
///
/// Blocks, and allocates: never to be called where motions are answered.
///
/// @param limit for all of it; only looking up a host's name may take longer
/// @throws std::runtime_error naming the URL and the reason: no connection, no answer in time, an answer that is not
/// HTTP or larger than 1 MiB, a certificate that is not accepted, the `refusal`
[[nodiscard]] Response ask(const Url& url, const Request& request, std::chrono::nanoseconds limit,
                           const Certificates& certificates = {});

}  // namespace forcebound::http
