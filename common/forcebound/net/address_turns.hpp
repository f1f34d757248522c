#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::net {

/// Which of a peer's addresses is sent to, and when its name is to be looked up again, while it does not answer.
///
/// An address has a turn of 250 ms, the Connection Attempt Delay of RFC 8305 (section 5); then the next one has. A
/// round of turns takes twice as long as the one before, up to 4 s each, so that an answer from afar still falls into
/// its address's own. One from which something came has 5 s to begin a session, since it may be another's by now; one
/// that had a session keeps it through 2 s of silence. A turn ends only with a datagram to send, so that each has one.
///
/// A name is looked up again once there was no session for 1 s, then after pauses of 1 s to 8 s.
///
/// Real time: noexcept, fixed size. Time is an argument. Not thread-safe.
class AddressTurns {
 public:
  static constexpr std::size_t kAddressesMost = 8;
  static constexpr time::Nanoseconds kTurnLeast = std::chrono::milliseconds{250};
  static constexpr time::Nanoseconds kTurnMost = std::chrono::seconds{4};
  static constexpr time::Nanoseconds kAnswered = std::chrono::seconds{5};
  static constexpr time::Nanoseconds kSilence = std::chrono::seconds{2};
  static constexpr time::Nanoseconds kLookUpLeast = std::chrono::seconds{1};
  static constexpr time::Nanoseconds kLookUpMost = std::chrono::seconds{8};

  explicit AddressTurns(time::Nanoseconds now) noexcept : since_(now), look_up_at_(now + kLookUpLeast) {}

  /// What the name leads to now, in the order in which it is to be tried; beyond kAddressesMost the rest is left out.
  /// The address that has its turn keeps it if it is still among them.
  void set(std::span<const Address> addresses, time::Nanoseconds now) noexcept;

  /// Whose turn it is; null: no address is known.
  [[nodiscard]] const Address* current() const noexcept { return count_ == 0 ? nullptr : &addresses_[current_]; }

  /// Something is about to be sent: ends a turn that has been long enough.
  void before_sending(time::Nanoseconds now) noexcept;

  // Of the address whose turn it is:
  /// There is no way to it, or nobody there. Its turn ends, unless it has answered.
  void on_unreachable(time::Nanoseconds now) noexcept;
  /// A datagram came from there.
  void on_received() noexcept;
  /// There is a session with the peer there, or what counts as one.
  void on_session(time::Nanoseconds now) noexcept;

  /// Whether the name is to be looked up now; true once for each time.
  [[nodiscard]] bool look_up_due(time::Nanoseconds now) noexcept;

 private:
  enum class Reached { nothing, something, session };

  void next(time::Nanoseconds now) noexcept;
  [[nodiscard]] time::Nanoseconds turn() const noexcept;

  std::array<Address, kAddressesMost> addresses_{};
  std::size_t count_ = 0;
  std::size_t current_ = 0;
  Reached reached_ = Reached::nothing;  ///< in this turn
  time::Nanoseconds since_;             ///< the turn's begin, or the last session in it
  time::Nanoseconds turn_ = kTurnLeast;
  time::Nanoseconds look_up_at_;
  time::Nanoseconds look_up_pause_ = kLookUpLeast;
};

}  // namespace forcebound::net
