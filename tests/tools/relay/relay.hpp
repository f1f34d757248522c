#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "tests/tools/netem/impairment.hpp"

namespace forcebound::relay {

using net::Address;
using netem::Direction;
using time::Nanoseconds;

/// Hands out links to the server, one per client, so that the server can tell them apart.
class UpstreamLinks {
 public:
  virtual ~UpstreamLinks() = default;

  /// A new link, valid until it is closed, or null if none is available.
  virtual net::DatagramLink* open() = 0;
  virtual void close(net::DatagramLink& link) = 0;
};

/// Receives the fate of every packet. Called by the relay: must not wait.
class PacketObserver {
 public:
  virtual ~PacketObserver() = default;

  /// A packet came: once for it, and once more for its copy.
  virtual void on_verdict(Direction direction, const netem::Verdict& verdict) noexcept = 0;

  /// A forwarded one left; its delay is final now.
  virtual void on_departure(Direction direction, const netem::Verdict& verdict) noexcept = 0;
};

struct RelaySettings {
  netem::ImpairmentSettings up{};
  netem::ImpairmentSettings down{};
  Address upstream{};
  std::size_t flows_max = 256;
  Nanoseconds flow_idle = std::chrono::seconds(60);  ///< a client without datagrams for this time is forgotten
};

/// The relay's own counts, besides its impairments.
struct RelayCounters {
  std::uint64_t flows_opened = 0;
  std::uint64_t flows_expired = 0;
  std::uint64_t flow_refused = 0;  ///< datagrams of clients for whom there was no room
  std::uint64_t orphaned = 0;      ///< left when their flow had been forgotten
  std::uint64_t send_failed = 0;   ///< left, but the system did not take them
};

/// Lateness of packets against the impairment's times: delay that the relay adds.
struct Lateness {
  std::uint64_t packets = 0;
  std::uint64_t late = 0;  ///< by more than kLate
  Nanoseconds total{0};
  Nanoseconds most{0};
  static constexpr Nanoseconds kLate = std::chrono::microseconds(500);
};

/// A bad network between clients and a server, as a datagram relay:
///
///     clients <--> downstream link | impairment up   --> | one upstream link per client <--> server
///                                  | <-- impairment down |
///
/// Pure: sockets, time and randomness come from outside. Not thread-safe.
class Relay {
 public:
  /// All references must outlive the relay; `observer` may be null.
  Relay(const RelaySettings& settings, net::DatagramLink& downstream, UpstreamLinks& links, PacketObserver* observer);

  /// Receives waiting datagrams, a bounded number from each link.
  void receive(Nanoseconds now);

  /// Sends due packets. To be called before and after `receive`.
  void forward(Nanoseconds now);

  /// Other impairments of one direction, for packets that come from now on.
  void change(Direction direction, const netem::NetemParameters& netem, Nanoseconds now) {
    way(direction).change(now, netem);
  }

  /// When `forward` has work again, unless something is received before.
  [[nodiscard]] std::optional<Nanoseconds> next_departure() const noexcept;

  [[nodiscard]] const netem::Impairment& impairment(Direction direction) const noexcept;
  [[nodiscard]] const RelayCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const Lateness& lateness() const noexcept { return lateness_; }
  [[nodiscard]] std::size_t flows() const noexcept { return flows_.size(); }

 private:
  struct Flow {
    std::uint64_t id;
    Address client;
    net::DatagramLink* upstream;
    Nanoseconds last_used;
  };

  void receive_from_clients(Nanoseconds now);
  void receive_from_server(Flow& flow, Nanoseconds now);
  void expire_idle_flows(Nanoseconds now);
  void push(Direction direction, Nanoseconds now, std::size_t bytes, std::uint64_t flow);
  bool forward_one(Direction direction, Nanoseconds now);
  void send(Direction direction, const netem::Departure& departure);
  void count_lateness(Nanoseconds late) noexcept;
  Flow* find_or_open(const Address& client, Nanoseconds now);
  Flow* find(std::uint64_t id) noexcept;
  netem::Impairment& way(Direction direction) noexcept { return direction == Direction::up ? up_ : down_; }

  Address upstream_;
  std::size_t flows_max_;
  Nanoseconds flow_idle_;
  net::DatagramLink& downstream_;
  UpstreamLinks& links_;
  PacketObserver* observer_;
  netem::Impairment up_;
  netem::Impairment down_;
  std::vector<Flow> flows_;
  std::vector<std::byte> buffer_;
  std::uint64_t next_flow_ = 1;
  RelayCounters counters_;
  Lateness lateness_;
};

}  // namespace forcebound::relay
