#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "forcebound/net/udp_link.hpp"

namespace forcebound::net {

/// Many datagrams in one system call: for a program with many peers on one socket.
///
/// Datagrams to send wait until `flush`; so a batch is received, answered, and its answers flushed. Failures count in
/// the link's `send_failed`.
///
/// Real time: nothing allocates after construction, and every call but `wait_for_some` returns at once. Not
/// thread-safe.
class UdpBatch final : public DatagramLink {
 public:
  static constexpr std::size_t kDatagramsMax = 32;

  /// A received datagram; its bytes are valid until the next `receive_all`.
  struct Arrived {
    std::span<const std::byte> bytes;  ///< cut to kDatagramBytesMax
    Received received;
  };

  /// @param link must outlive it
  explicit UdpBatch(UdpLink& link);
  ~UdpBatch() override;
  UdpBatch(const UdpBatch&) = delete;
  UdpBatch& operator=(const UdpBatch&) = delete;

  /// The oldest waiting datagrams, in order, at most kDatagramsMax.
  [[nodiscard]] std::span<const Arrived> receive_all() noexcept;

  /// The same, but sleeps until there is one, for no longer than the link's `wait_at_most` says; a signal wakes it too.
  /// One call of the system where waiting and then receiving are two.
  [[nodiscard]] std::span<const Arrived> wait_for_some() noexcept;

  /// Keeps a copy for `flush`; if there is no room for it, flushes first. False if it is larger than kDatagramBytesMax.
  bool send(std::span<const std::byte> datagram, const Address& to) noexcept override;

  /// Sends what waits.
  void flush() noexcept;

  /// Sends one datagram directly, without the batch.
  std::optional<Received> receive(std::span<std::byte> buffer) noexcept override { return link_.receive(buffer); }

 private:
  [[nodiscard]] std::span<const Arrived> receive(int flags) noexcept;

  struct Storage;
  UdpLink& link_;
  std::unique_ptr<Storage> storage_;
};

}  // namespace forcebound::net
