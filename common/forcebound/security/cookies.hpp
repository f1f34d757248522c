#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "forcebound/security/keys.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::security {

inline constexpr std::size_t kCookieBytes = 16;
using Cookie = std::array<std::byte, kCookieBytes>;

/// Shows that who asks receives at the address that it asks from, without any memory of it: a cookie is a keyed hash
/// (BLAKE2b, RFC 7693) of the address and of the period of time in which it was made. It is good in that period and the
/// next: for kPeriod at least, for twice that at most.
///
/// Real time: noexcept, no allocation, below 1 us. A moved-from one must not be used.
class Cookies {
 public:
  /// Longer than a round trip (12 s has been observed), and so short that a client makes another request meanwhile: a
  /// recorded one is of use for no longer.
  static constexpr time::Nanoseconds kPeriod = std::chrono::seconds(20);

  /// @param key of this end alone; 32 random bytes
  explicit Cookies(SecretKey key) noexcept : key_(std::move(key)) {}

  /// @param address any bytes that name it, always the same
  /// @param now not negative
  [[nodiscard]] Cookie made_for(std::span<const std::byte> address, time::Nanoseconds now) const noexcept;

  /// In a time that does not depend on the cookie.
  [[nodiscard]] bool is_good(const Cookie& cookie, std::span<const std::byte> address,
                             time::Nanoseconds now) const noexcept;

 private:
  [[nodiscard]] Cookie made_in(time::Nanoseconds::rep period, std::span<const std::byte> address) const noexcept;

  SecretKey key_;
};

}  // namespace forcebound::security
