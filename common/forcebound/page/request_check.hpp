#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace forcebound::page {

/// Random bytes as a token in an address: lower-case hexadecimal digits.
[[nodiscard]] std::string token_of(std::span<const std::byte> random);

/// Compares in a time that depends on the lengths alone, so that a token cannot be guessed digit by digit.
[[nodiscard]] bool equal_in_constant_time(std::string_view one, std::string_view other) noexcept;

/// The path of a request's target, without its query: "/live" of "/live?token=1".
[[nodiscard]] std::string_view path_of(std::string_view target) noexcept;

/// The value of a key of the query; empty: there is none. It is not unescaped, which a token does not need.
[[nodiscard]] std::string_view query_value(std::string_view target, std::string_view key) noexcept;

/// The token of a header `Authorization: Bearer TOKEN`; empty: there is none.
[[nodiscard]] std::string_view bearer_token(std::string_view authorization) noexcept;

/// By which names a page may be asked for. A name server that somebody else controls can make a browser take his page
/// for one of this machine; that browser then names his host.
class HostCheck {
 public:
  /// @param host that is listened at, as given; every address of this machine where it is 0.0.0.0 or ::
  HostCheck(std::string host, std::uint16_t port);

  /// Of a header `Host`: localhost, 127.0.0.1, [::1] or the host that is listened at, with our port. If all addresses
  /// are listened at, any numeric address too, but no other name.
  [[nodiscard]] bool accepts(std::string_view host_and_port) const;

  /// Of a header `Origin`: http:// and a host that is accepted.
  [[nodiscard]] bool accepts_origin(std::string_view origin) const;

 private:
  std::string host_;
  std::string port_;
  bool everywhere_;
};

}  // namespace forcebound::page
