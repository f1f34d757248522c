#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/server/session/counters.hpp"
#include "forcebound/server/session/observer.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::server {

struct Session;

inline constexpr const char* kNoMemory = "not enough memory for another session, try again later";

/// Why a Hello opens no session.
struct Refused {
  wire::RefusalReason reason;
  std::string text;  ///< for people
};

/// What a server sends: encodes it and gives it to the link, and counts what the link does not take. Keeps no copy:
/// clients repeat what was lost.
///
/// Not thread-safe.
class Replies {
 public:
  /// All must outlive this.
  Replies(net::DatagramLink& link, ServerCounters& counters, ServerObserver& observer) noexcept
      : link_(link), counters_(counters), observer_(observer) {}

  /// Real time: no allocation. @returns whether the link took it
  bool send(const wire::Message& message, const net::Address& to) noexcept { return send(codec_.encode(message), to); }

  /// What `encode` gave. Real time: no allocation.
  bool send(std::span<const std::byte> datagram, const net::Address& to) noexcept;

  /// Valid until the next call.
  [[nodiscard]] std::span<const std::byte> encode(const wire::EnvironmentForce& force) noexcept {
    return codec_.encode(force);
  }

  /// To an address that may be forged, in answer to so many bytes: nothing larger is sent. Real time: no allocation.
  void send_within(std::size_t bytes, const wire::Message& message, const net::Address& to) noexcept;

  /// Tells the client of a session that it has it, and the observer unless it knows.
  /// @param repeated the client has been told before. @throws std::bad_alloc nobody was told
  void welcome(const Session& session, bool repeated);

  /// Tells the observer too, and counts it. @throws std::bad_alloc
  void refuse(const wire::Hello& hello, const net::Address& from, const Refused& refused);

  /// There was no memory even to look at the Hello. If there is none for the refusal either, the client repeats it.
  void refuse_for_lack_of_memory(const wire::Hello& hello, const net::Address& from) noexcept;

  /// This answer is what the client measures the round trip by; no state is kept for it.
  void ask_for_round_trip(const wire::Hello& hello, const net::Address& from);

 private:
  net::DatagramLink& link_;
  ServerCounters& counters_;
  ServerObserver& observer_;
  wire::Codec codec_;
};

}  // namespace forcebound::server
