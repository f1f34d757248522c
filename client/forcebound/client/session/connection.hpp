#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "forcebound/client/session/session_state.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// Whether there is a session with the server, and when to ask for one.
///
/// connecting: never had one. active: forces come. stale: none for longer than the policy's hold time. reconnecting:
/// none for longer than its drop time, or the server does not know us; Hellos go out, and the motion as well as long as
/// the session may still be alive. Hello pauses grow from 100 ms to 2 s. One nonce stays in use until the server has
/// refused the session, so that a late Welcome is as good as an early one.
///
/// Real time: noexcept, no allocation after construction.
class Connection {
 public:
  struct Facts {
    std::string device;
    std::string scene;   ///< wanted, empty: the server's own
    std::string port{};  ///< of the law, empty: it needs no server-side law
    int degrees_of_freedom = 1;
    double period_s = 1e-3;
    double force_N_max = 0;
  };

  Connection(Facts facts, std::uint64_t seed);

  [[nodiscard]] SessionState state() const noexcept { return state_; }

  /// 0: none.
  [[nodiscard]] std::uint64_t session() const noexcept { return session_; }

  /// The force stream's blackout: time since the last new force, or since the session began.
  void on_blackout(Nanoseconds blackout, Nanoseconds hold, Nanoseconds drop) noexcept;

  /// True if this begins another session.
  bool on_welcome(const wire::Welcome& welcome) noexcept;

  enum class Refused : std::uint8_t {
    not_us,
    session,  ///< the one that was is no more
    hello,    ///< for people to know why
    for_now,  ///< until the next Hello, which tells the round trip
  };

  /// @param now when it arrived
  Refused on_refusal(const wire::Refusal& refusal, Nanoseconds now) noexcept;

  /// The server ended the session.
  void on_bye() noexcept { lose_session(); }

  /// Whether a Hello should go out now; if so, the next is due after the pause.
  [[nodiscard]] bool hello_due(Nanoseconds now) noexcept;
  /// @param now as in `on_refusal`
  [[nodiscard]] wire::Hello hello(Nanoseconds now) const noexcept;

  [[nodiscard]] std::uint64_t sessions() const noexcept { return sessions_; }

 private:
  void lose_session() noexcept;

  Facts facts_;
  std::mt19937_64 random_;
  SessionState state_ = SessionState::connecting;
  std::uint64_t nonce_;
  std::uint64_t session_ = 0;
  std::uint64_t replaced_ = 0;  // the session before, of the same nonce
  std::uint64_t sessions_ = 0;
  Nanoseconds next_hello_{Nanoseconds::min()};
  Nanoseconds pause_;
  Nanoseconds round_trip_{0};  // as a server wanted to know it
};

}  // namespace forcebound::client
