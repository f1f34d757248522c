#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "forcebound/security/channel.hpp"

namespace forcebound::server {

/// Counts of a SecureLink's events, by reason. Whatever is dropped is counted here.
struct SecureCounters {
  std::uint64_t cookies_offered = 0;
  std::uint64_t handshakes = 0;                ///< answered, and whoever asked let in
  std::uint64_t handshakes_later = 0;          ///< of sessions that there were: another key
  std::uint64_t handshakes_again = 0;          ///< copies of a request, which got the same answer
  std::uint64_t handshakes_not_allowed = 0;    ///< of a public key that is not in the list, or not the session's
  std::uint64_t handshakes_full = 0;           ///< no room for one more, or no memory
  std::uint64_t handshakes_not_authentic = 0;  ///< forged or damaged, or another server's or shared key
  std::uint64_t handshakes_malformed = 0;      ///< too short, of another pattern, or no request
  std::uint64_t handshakes_not_proven = 0;     ///< not of a client of the list or the shared key, or recorded
  std::uint64_t handshakes_over_rate = 0;
  std::uint64_t handshakes_crowded = 0;                      ///< too many waited, of all, of a source or of a client
  std::uint64_t handshakes_overtaken = 0;                    ///< requests for another key that came after a newer one
  std::uint64_t addresses_of_others = 0;                     ///< records from where another client was just heard
  std::uint64_t handshakes_failed = 0;                       ///< not answered for lack of memory or randomness
  std::uint64_t handshakes_unused = 0;                       ///< let in, and then no record came
  std::uint64_t sessions_idle = 0;                           ///< no record came for too long, or no new key
  std::uint64_t in_clear = 0;                                ///< neither sealed nor of a handshake
  std::uint64_t hellos_in_clear = 0;                         ///< of these: refused
  std::array<std::uint64_t, security::kOpenings> records{};  ///< sealed datagrams, by security::Opening

  /// Adds those of another link.
  void add(const SecureCounters& other) noexcept;

  /// One line per subject, without counts that are zero.
  [[nodiscard]] std::string text() const;
};

}  // namespace forcebound::server
