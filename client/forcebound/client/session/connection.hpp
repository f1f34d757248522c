#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>

#include "forcebound/record/session_state.hpp"
#include "forcebound/wire/codec.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

using record::SessionState;
using time::Nanoseconds;

/// State of the session with the server, and the times at which Hellos are sent.
///
/// connecting: no session yet. active: forces arrive. stale: none for longer than the policy's hold time. reconnecting:
/// none for longer than its drop time, or the server does not know the session; Hellos are sent, and motion too as long
/// as the session may still exist. Pauses between Hellos grow from 100 ms to 2 s. The nonce changes only when the
/// server has refused the session, so that a late Welcome is still valid.
///
/// The round trip is measured only by the echo of a Hello that was sent, within kRoundTripMost: a forged time measures
/// nothing. It is forgotten, and measured anew, once a Hello with it was refused or should long have been answered.
///
/// Real time: noexcept, no allocation after construction.
class Connection {
 public:
  /// No longer round trip is believed; 12 s has been observed.
  static constexpr Nanoseconds kRoundTripMost = std::chrono::seconds{20};

  struct Facts {
    std::string device{};
    std::string scene{};       ///< requested; empty: the server's default
    std::string server_law{};  ///< that the law needs; empty: none
    int degrees_of_freedom = 1;
    double period_s = 1e-3;
    double force_N_max = 0;
    bool renders_locally = false;
    bool shows_scene = false;
    bool shows_torque = false;
  };

  Connection(Facts facts, std::uint64_t seed);

  [[nodiscard]] SessionState state() const noexcept { return state_; }

  /// The session's number; 0: none.
  [[nodiscard]] std::uint64_t session() const noexcept { return session_; }

  /// The force stream's blackout: time since the last new force, or since the session began.
  void on_blackout(Nanoseconds blackout, Nanoseconds hold, Nanoseconds drop) noexcept;

  /// Whether a datagram with this heading can be meant for this client: of its session or the one that ended last, or
  /// an answer to its Hello. All others are foreign, whatever they say.
  [[nodiscard]] bool is_for_us(const wire::Heading& heading) const noexcept;

  /// True if this begins a new session.
  bool on_welcome(const wire::Welcome& welcome) noexcept;

  enum class Refused : std::uint8_t {
    not_us,
    session,  ///< the session no longer exists
    hello,    ///< the reason is for the user
    for_now,  ///< until the next Hello, which has the round trip
  };

  /// @param now when it arrived
  Refused on_refusal(const wire::Refusal& refusal, Nanoseconds now) noexcept;

  /// The server ended the session.
  void on_bye() noexcept { lose_session(); }

  /// Whether a Hello should go out now; if so, the next is due after the pause.
  [[nodiscard]] bool hello_due(Nanoseconds now) noexcept;
  /// The Hello to send now; its echo measures the round trip. @param now as in `on_refusal`
  [[nodiscard]] wire::Hello hello(Nanoseconds now) noexcept;

  [[nodiscard]] std::uint64_t sessions() const noexcept { return sessions_; }

 private:
  void lose_session() noexcept;
  void forget_round_trip() noexcept;
  /// From the Hello that was sent at `client_time`; none: there was no such Hello, or it was too long ago.
  [[nodiscard]] std::optional<Nanoseconds> round_trip_of(Nanoseconds client_time, Nanoseconds now) const noexcept;

  // Enough for the longest round trip, with the pauses between Hellos.
  static constexpr std::size_t kHellosKept = 32;

  Facts facts_;
  std::mt19937_64 random_;
  SessionState state_ = SessionState::connecting;
  std::uint64_t nonce_;
  std::uint64_t session_ = 0;
  std::uint64_t replaced_ = 0;  // the session before, of the same nonce
  std::uint64_t lost_ = 0;      // the session that ended last, whose datagrams may be on their way
  std::uint64_t sessions_ = 0;
  Nanoseconds next_hello_{Nanoseconds::min()};
  Nanoseconds pause_;
  Nanoseconds round_trip_{0};  // measured for a server that asked for it; 0: not measured
  Nanoseconds measured_{0};    // when
  std::array<std::optional<Nanoseconds>, kHellosKept> hellos_{};  // times of the last, a ring buffer
  std::size_t hellos_next_ = 0;
};

}  // namespace forcebound::client
