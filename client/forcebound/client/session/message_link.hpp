#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include "forcebound/client/session/connection.hpp"
#include "forcebound/net/datagram_link.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::client {

/// Messages to and from one server over datagrams. Whatever is malformed, from another sender or not for this client is
/// dropped and counted.
///
/// Real time: noexcept, no allocation after construction.
class MessageLink {
 public:
  /// @param datagrams and @param clock must outlive this
  MessageLink(net::DatagramLink& datagrams, const time::Clock& clock, const net::Address& server)
      : datagrams_(datagrams), clock_(clock), server_(server) {}

  /// False if the system did not take the datagram, which is counted.
  bool send(const wire::Message& message) noexcept;

  /// Whether a datagram can be sent at all now.
  [[nodiscard]] bool ready() const noexcept { return datagrams_.ready(); }

  /// Datagrams that one tick has received so far: its work is bounded, and what is beyond waits for the next.
  struct Received {
    int decoded = 0;
    int dropped = 0;  ///< by their address or heading
  };

  struct Arrival {
    const wire::Message& message;  ///< valid until the next call; neither a Hello nor a motion
    Nanoseconds at{0};             ///< when it arrived at this machine
  };

  /// The next message of this tick; none: nothing has arrived, or this tick has received its share.
  /// @param connection decides which headings are for this client
  [[nodiscard]] std::optional<Arrival> receive(const Connection& connection, Received& in_tick) noexcept;

  struct Counts {
    std::uint64_t foreign = 0;  ///< of another session or sender
    wire::MalformedCounts malformed{};
    std::uint64_t send_failures = 0;
  };

  /// A message that arrived turned out to be of another session.
  void count_foreign() noexcept { ++counts_.foreign; }

  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  /// None: the datagram is dropped, and counted.
  [[nodiscard]] std::optional<wire::Heading> heading_of(std::span<const std::byte> datagram,
                                                        const Connection& connection) noexcept;

  net::DatagramLink& datagrams_;
  const time::Clock& clock_;
  net::Address server_;
  wire::Codec codec_;
  std::array<std::byte, net::kDatagramBytesMax + 1> buffer_{};  // one more, so that an oversize datagram shows
  std::variant<wire::Message, wire::Malformed> decoded_;
  Counts counts_;
};

}  // namespace forcebound::client
