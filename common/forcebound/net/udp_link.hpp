#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::net {

/// Errors that a UDP socket reported.
struct UdpCounters {
  std::uint64_t refused = 0;      ///< port unreachable (ICMP) received from the peer's machine
  std::uint64_t overflowed = 0;   ///< datagrams dropped because the buffer was full
  std::uint64_t send_failed = 0;  ///< the system did not take a datagram: no route, no memory, too large
};

/// A UDP socket, IPv4 or IPv6: one file descriptor, beside three that all of a process share. None may outlive `main`.
///
/// Real time: send and receive return at once and allocate nothing. Not thread-safe.
class UdpLink final : public DatagramLink {
 public:
  /// Whether the system stamps each datagram on arrival, for Received::waited; otherwise that is zero, and receiving
  /// costs less.
  enum class Stamps { taken, left_out };

  /// A server's end: bound to `local`; port 0 takes any free one. "::" also takes IPv4.
  ///
  /// @throws std::runtime_error with the reason: in use, not an address of this machine, not permitted.
  static UdpLink listen(const Address& local, Stamps stamps = Stamps::taken);

  /// A server's end that somebody else has bound, as a service manager does. Takes the descriptor over.
  ///
  /// @throws std::runtime_error if it is no bound UDP socket, IPv4 or IPv6
  static UdpLink adopt(int descriptor, Stamps stamps = Stamps::taken);

  /// Another socket at the same address, so that the system distributes what arrives there (SO_REUSEPORT): by a hash of
  /// both addresses, if no filter is attached. No other user's program, and no `listen`, can bind there too.
  ///
  /// @throws std::runtime_error with the reason
  static UdpLink beside(UdpLink& first, Stamps stamps = Stamps::taken);

  /// A client's end: any free port, connected, so that only `peer`'s datagrams are received and its errors seen
  /// (`refused`).
  ///
  /// @throws std::runtime_error with the reason, such as no route.
  static UdpLink towards(const Address& peer);

  /// A client's end whose peer `direct_to` says, and may change: an address of either kind, where this machine has
  /// both.
  ///
  /// @throws std::runtime_error with the reason
  static UdpLink towards_nobody();

  /// From now on only this peer's datagrams arrive, beside those of one before that wait already; the port of ours is
  /// another. False: there is no way to it now. Real time: returns at once, allocates nothing.
  bool direct_to(const Address& peer) noexcept;

  UdpLink(UdpLink&&) noexcept;
  UdpLink& operator=(UdpLink&&) noexcept;
  ~UdpLink() override;

  bool send(std::span<const std::byte> datagram, const Address& to) noexcept override;
  std::optional<Received> receive(std::span<std::byte> buffer) noexcept override;

  /// How long UdpBatch::wait_for_some sleeps at most, to the system's timer resolution (1 to 10 ms). Not real time.
  void wait_at_most(time::Nanoseconds duration) noexcept;

  [[nodiscard]] Address local_address() const noexcept;
  /// As in `counters`, without asking the system.
  [[nodiscard]] std::uint64_t refused() const noexcept;
  /// Asks the system: a call of it, not for each tick.
  [[nodiscard]] UdpCounters counters() const noexcept;

  /// The file descriptor, for waiting.
  [[nodiscard]] int descriptor() const noexcept;

 private:
  friend class UdpBatch;
  void count_refused() noexcept;
  [[nodiscard]] bool stamped() const noexcept;
  void count_send_failed() noexcept;

  struct Socket;
  explicit UdpLink(std::unique_ptr<Socket> socket) noexcept;
  std::unique_ptr<Socket> socket_;
};

/// Sleeps until one of the descriptors can be read or `timeout` has passed, to the nanosecond where the system can do
/// so; a signal wakes it too. True if something can be read. At most kWaitableMax descriptors.
bool wait_readable(std::span<const int> descriptors, time::Nanoseconds timeout) noexcept;
inline constexpr std::size_t kWaitableMax = 1024;

}  // namespace forcebound::net
