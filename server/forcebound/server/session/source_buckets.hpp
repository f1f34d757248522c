#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/time/token_bucket.hpp"

namespace forcebound::server {

/// Where a datagram comes from, whatever the port: an IPv4 address, or the first 56 bits of an IPv6 one, which is what
/// a site is given (RFC 6177). Another number for each.
[[nodiscard]] inline std::uint64_t source_of(const net::Address& from) noexcept {
  const auto word = [&](std::size_t at) {
    std::uint64_t value = 0;
    for (std::size_t i = at; i < at + 8; ++i) value = value << 8U | from.ip[i];
    return value;
  };
  // ::ffff:a.b.c.d (RFC 4291, section 2.5.5.2); not just any address with these two bytes in its lower half.
  const bool is_ipv4 = word(0) == 0 && from.ip[8] == 0 && from.ip[9] == 0 && from.ip[10] == 0xff && from.ip[11] == 0xff;
  constexpr std::uint64_t kWithinSite = 0xff;
  return is_ipv4 ? word(8) : word(0) & ~kWithinSite;
}

/// A token bucket for each source of datagrams that may be forged, so that a flood from one uses up its own rate and no
/// other's.
///
/// A fixed number of buckets is shared by all, by a keyed hash: memory and the total rate stay bounded however many
/// sources are forged, and nobody who does not know the key can choose a bucket. [Stochastic fairness, McKenney 1990]
/// For who has shown where it receives there is ExactBuckets.
///
/// Real time: `take` is noexcept, allocates nothing, O(1). Not thread-safe.
class SourceBuckets {
 public:
  static constexpr std::size_t kBuckets = 64;

  /// @param key random
  SourceBuckets(time::Nanoseconds interval, int burst, time::Nanoseconds now, std::uint64_t key)
      : key_(key), buckets_(kBuckets, time::TokenBucket(interval, burst, now)) {}

  [[nodiscard]] bool take(const net::Address& from, time::Nanoseconds now) noexcept {
    return buckets_[index(from)].take(now);
  }

  [[nodiscard]] std::size_t index(const net::Address& from) const noexcept {
    std::uint64_t hash = mixed(key_ ^ source_of(from));
    hash = mixed(hash ^ key_);
    return static_cast<std::size_t>(hash % kBuckets);
  }

 private:
  // SplitMix64's finaliser [Steele, Lea and Flood 2014].
  static std::uint64_t mixed(std::uint64_t x) noexcept {
    x = (x ^ x >> 30U) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ x >> 27U) * 0x94d049bb133111ebULL;
    return x ^ x >> 31U;
  }

  std::uint64_t key_;
  std::vector<time::TokenBucket> buckets_;
};

}  // namespace forcebound::server
