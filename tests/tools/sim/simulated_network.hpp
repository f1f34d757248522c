#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/time/clock.hpp"
#include "tests/tools/netem/impairment.hpp"

namespace forcebound::sim {

using net::Address;
using netem::Direction;
using time::Nanoseconds;

/// The impairments of each direction. The seeds and origins in here are replaced by the network's.
struct SimulatedNetworkSettings {
  netem::NetemParameters up{};
  netem::NetemParameters down{};
  std::optional<netem::NetworkTrace> trace{};  ///< applies to both ways
  std::uint64_t seed = 1;
};

/// What was sent, and datagrams lost for other reasons than an impairment.
struct SimulatedNetworkCounters {
  std::array<std::uint64_t, 2> bytes_sent{};  ///< payloads of each direction: up, down
  std::uint64_t blackholed = 0;               ///< sent while their direction was blackholed
  std::uint64_t server_detached = 0;          ///< delivered while there was no server
  std::uint64_t inbox_full = 0;               ///< delivered to an end that did not read
};

/// A server and any number of clients, joined by one impaired link per direction, in one process and virtual time:
///
///     client 0 --+                          +--> handler, or receive()
///     client 1 --+--> impairment up ------> |  server
///     client 0 <-+                          |
///     client 1 <-+<-- impairment down <-----+
///
/// Time is the clock's, and the network never sets it. Receiving first delivers all that is due, so on a network
/// without delay a client that sends gets the handler's answer within the same tick. Everything is decided by the
/// seed, the parameters and the order of calls: bit for bit the same run each time.
///
/// The clock must outlive the network, the network its links. Not thread-safe.
class SimulatedNetwork {
 public:
  /// Called for each datagram that reaches the server. `now` is the time of its arrival, even if the clock is ahead.
  using ServerHandler = std::function<void(std::span<const std::byte> datagram, const Address& from, Nanoseconds now)>;

  SimulatedNetwork(const time::Clock& clock, const SimulatedNetworkSettings& settings);
  ~SimulatedNetwork();
  SimulatedNetwork(const SimulatedNetwork&) = delete;
  SimulatedNetwork& operator=(const SimulatedNetwork&) = delete;

  /// A new client's end, with an address of its own. Valid as long as the network.
  net::DatagramLink& add_client();
  [[nodiscard]] Address client_address(std::size_t client) const noexcept;

  /// The server's end. Sending inside the handler happens at the handler's `now`.
  net::DatagramLink& server_link() noexcept;
  [[nodiscard]] Address server_address() const noexcept;

  /// From now on datagrams go to the handler instead of the server link's receive().
  void set_server_handler(ServerHandler handler);

  /// Kills the server: datagrams for it are lost, and unread ones too. Its last answers still travel.
  void detach_server() noexcept;
  void attach_server() noexcept { server_attached_ = true; }

  /// Drops all that is sent in a direction; datagrams in flight still arrive.
  void set_blackhole(Direction direction, bool on) noexcept;

  /// Delivers all that is due up to `now`, in the order of time, answers of the handler included.
  void deliver_due(Nanoseconds now);

  /// When `deliver_due` has work again. May be too early, never too late.
  [[nodiscard]] std::optional<Nanoseconds> next_event() const noexcept;

  [[nodiscard]] const netem::ImpairmentCounters& counters(Direction direction) const noexcept;
  [[nodiscard]] const SimulatedNetworkCounters& counters() const noexcept { return counters_; }

  /// Changes whatever the server sends.
  using Tamper = std::function<std::span<const std::byte>(std::span<const std::byte> datagram, Nanoseconds now)>;
  void set_tamper(Tamper tamper) { tamper_ = std::move(tamper); }

  /// Called for each verdict of either direction, as it is made.
  using VerdictObserver = std::function<void(Direction, const netem::Verdict&)>;
  void set_verdict_observer(VerdictObserver observer) { observer_ = std::move(observer); }

 private:
  class ClientLink;
  class ServerLink;
  struct Datagram {
    std::vector<std::byte> bytes;
    Address from;
    Nanoseconds arrival;
  };
  using Inbox = std::deque<Datagram>;

  bool send(Direction direction, std::span<const std::byte> datagram, std::uint64_t client);
  void deliver(Direction direction, const netem::Departure& departure);
  void put(Inbox& inbox, std::span<const std::byte> bytes, const Address& from);
  std::optional<net::Received> take(Inbox& inbox, std::span<std::byte> buffer);
  [[nodiscard]] Nanoseconds now() const noexcept { return event_time_.value_or(clock_.now()); }
  netem::Impairment& way(Direction direction) noexcept { return ways_[static_cast<std::size_t>(direction)]; }

  const time::Clock& clock_;
  std::array<netem::Impairment, 2> ways_;  // up, down
  std::array<bool, 2> blackhole_{};
  std::unique_ptr<ServerLink> server_;
  std::vector<std::unique_ptr<ClientLink>> clients_;
  ServerHandler handler_;
  VerdictObserver observer_;
  Tamper tamper_;
  bool server_attached_ = true;
  std::optional<Nanoseconds> event_time_;  // set while delivering
  SimulatedNetworkCounters counters_;
};

}  // namespace forcebound::sim
