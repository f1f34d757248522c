#pragma once

#include <cstdint>
#include <string>

#include "forcebound/security/channel.hpp"

namespace forcebound::server {

/// Events of a SecureLink that are counted: COUNT(SUBJECT, NAME, WORDS), in the order in which they are told after
/// those of sealed datagrams. A new counter is a new row, and a line that counts.
#define FORCEBOUND_SECURE_COUNTS(COUNT)                                                                                \
  COUNT("sealed datagrams", addresses_of_others,                                                                       \
        "opened, but from another client's address") /* records from where another client was just heard */            \
  COUNT("handshakes", handshakes, "answered")        /* answered, and whoever asked let in */                          \
  COUNT("handshakes", handshakes_later, "for another key of a session") /* of sessions that there were: another key */ \
  COUNT("handshakes", handshakes_again, "copies answered again") /* copies of a request, which got the same answer */  \
  COUNT("handshakes", cookies_offered, "by cookies alone")                                                             \
  COUNT("handshakes", handshakes_not_allowed,                                                                          \
        "of clients that are not allowed") /* of a public key that is not in the list, or not the session's */         \
  COUNT("handshakes", handshakes_full, "for which there was no room") /* no room for one more, or no memory */         \
  COUNT("handshakes", handshakes_not_authentic,                                                                        \
        "not authentic") /* forged or damaged, or another server's or shared key */                                    \
  COUNT("handshakes", handshakes_malformed,                                                                            \
        "malformed or of another pattern") /* too short, of another pattern, or no request */                          \
  COUNT("handshakes", handshakes_not_proven,                                                                           \
        "not proven to be of who may come in") /* not of a client of the list or the shared key, or recorded */        \
  COUNT("handshakes", handshakes_over_rate, "over the rate")                                                           \
  COUNT("handshakes", handshakes_crowded,                                                                              \
        "beyond those that may wait") /* too many waited, of all, of a source or of a client */                        \
  COUNT("handshakes", handshakes_overtaken,                                                                            \
        "overtaken by a newer one") /* requests for another key that came after a newer one */                         \
  COUNT("handshakes", handshakes_failed,                                                                               \
        "without memory for them") /* not answered for lack of memory or randomness */                                 \
  COUNT("handshakes", handshakes_unused, "not followed by a session") /* let in, and then no record came */            \
  COUNT("handshakes", sessions_idle,                                                                                   \
        "whose session was idle or lacked a new key")  /* no record came for too long, or no new key */                \
  COUNT("datagrams in the clear", in_clear, "dropped") /* neither sealed nor of a handshake */                         \
  COUNT("datagrams in the clear", hellos_in_clear, "of them Hellos refused") /* of these: refused */

/// Counts of a SecureLink's events, by reason. Whatever is dropped is counted here.
struct SecureCounters {
#define FORCEBOUND_MEMBER(subject, name, words) std::uint64_t name = 0;
  FORCEBOUND_SECURE_COUNTS(FORCEBOUND_MEMBER)
#undef FORCEBOUND_MEMBER
  security::OpeningCounts records{};

  /// Adds those of another link.
  void add(const SecureCounters& other) noexcept;

  /// One line per subject, without counts that are zero.
  [[nodiscard]] std::string text() const;
};

}  // namespace forcebound::server
