#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "forcebound/client/security/handshaker.hpp"
#include "forcebound/net/datagram_link.hpp"
#include "forcebound/security/channel.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// Seals all that a client sends to its server, and passes on only what the server has sealed: a link in front of
/// another, of which the session above knows nothing.
///
/// Until a handshake has given keys, nothing is sent (`ready`). A new session of keys begins when there is none, when
/// its keys have expired, or when kUnansweredLeast datagrams or more, but for handshakes, were sent under them without
/// one that could be opened since, the first of them kSilence ago (kFirstSilence, if none has ever been opened): the
/// server may have been restarted, and then knows these keys no more. Meanwhile they are used as before, since it may
/// just as well be the network that is silent.
///
/// Real time: noexcept, no allocation; handshakes are the handshaker's, on another thread. A datagram costs about 1 us.
/// Owned by the tick's thread.
class SecureLink final : public net::DatagramLink {
 public:
  /// A client is to be back within a second of a server's restart.
  static constexpr Nanoseconds kSilence = std::chrono::milliseconds{500};
  /// Under new keys the first answer takes a whole round trip, which may exceed kSilence.
  static constexpr Nanoseconds kFirstSilence = std::chrono::seconds{5};
  /// One datagram of a client that sends rarely may be lost.
  static constexpr int kUnansweredLeast = 3;

  /// All must outlive it. @throws std::bad_alloc if there is no memory for keys
  SecureLink(net::DatagramLink& link, const net::Address& server, Handshaker& handshaker, const time::Clock& clock);

  bool send(std::span<const std::byte> datagram, const net::Address& to) noexcept override;

  /// The content of the oldest sealed datagram. What cannot be opened is dropped and counted; after many the
  /// rest waits for the next tick.
  std::optional<net::Received> receive(std::span<std::byte> buffer) noexcept override;

  [[nodiscard]] bool ready() const noexcept override;

  // What `send` and `receive` consist of, for a program that sends or receives many datagrams in one system call.

  /// The sealed datagram, valid until the next is asked for; empty: there are no keys.
  [[nodiscard]] std::span<const std::byte> seal(std::span<const std::byte> content) noexcept;

  /// The content's length; nothing: dropped and counted, or of a handshake.
  [[nodiscard]] std::optional<std::size_t> open(std::span<const std::byte> datagram,
                                                std::span<std::byte> buffer) noexcept;

  /// Takes keys from the handshaker, and sends for it. To be called every few milliseconds.
  void exchange() noexcept;

  struct Counters {
    std::uint64_t sessions = 0;            ///< first handshakes that gave keys
    std::uint64_t rekeys = 0;              ///< later ones
    std::uint64_t in_clear = 0;            ///< datagrams that are not sealed, nor of a handshake
    std::uint64_t handshakes_dropped = 0;  ///< datagrams of handshakes that nobody waits for
    security::OpeningCounts by_opening{};
  };
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

 private:
  // Most datagrams that one call drops; one that only its tag shows to be forged counts for more, as it takes longer.
  static constexpr int kCostMost = 512;
  static constexpr int kForgedCost = 7;

  /// `seal` of what need not be answered.
  [[nodiscard]] std::span<const std::byte> seal_unanswered(std::span<const std::byte> content,
                                                           Nanoseconds now) noexcept;
  void install_keys(const Handshaker::Made& made, Nanoseconds now) noexcept;
  [[nodiscard]] Handshaker::Wanted wanted(Nanoseconds now) const noexcept;
  [[nodiscard]] bool is_unanswered(Nanoseconds now) const noexcept;
  [[nodiscard]] security::Channel& newest() noexcept { return channels_[newest_]; }
  [[nodiscard]] const security::Channel& newest() const noexcept { return channels_[newest_]; }

  net::DatagramLink& link_;
  net::Address server_;
  Handshaker& handshaker_;
  const time::Clock& clock_;
  // The session of keys that is used, and the one before, of which datagrams may be on their way.
  std::array<security::Channel, 2> channels_{security::Channel({}), security::Channel({})};
  std::size_t newest_ = 0;
  // Under the newest session of keys:
  bool any_opened_ = false;
  int unanswered_ = 0;               ///< datagrams sent since one was opened, up to kUnansweredLeast
  Nanoseconds unanswered_since_{0};  ///< when the first of them was sent
  Handshaker::Outgoing outgoing_{};
  std::array<std::byte, net::kDatagramBytesMax> sealed_{};
  std::array<std::byte, net::kDatagramBytesMax + 1> received_{};  // one more, so that an oversize datagram shows
  Counters counters_;
};

}  // namespace forcebound::client
