#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::sim {

using net::Address;
using time::Nanoseconds;

/// The queue of a server with computing time: as the program, it takes in all that has come, computes once, and
/// answers; datagrams that come meanwhile wait for the next turn.
class BusyServer {
 public:
  explicit BusyServer(Nanoseconds turn) : turn_(turn) {}

  /// A datagram comes, at a time that never runs backwards.
  void arrive(std::span<const std::byte> datagram, const Address& from, Nanoseconds now);

  /// The end of the present turn.
  [[nodiscard]] std::optional<Nanoseconds> next_event() const noexcept;

  /// To be called then: returns all datagrams of this turn, in order, and begins the next turn.
  void end_turn(const std::function<void(std::span<const std::byte>, const Address&, Nanoseconds arrival)>& receive);

  /// The server is killed: drops all that waits.
  void forget() noexcept;

 private:
  struct Datagram {
    std::vector<std::byte> bytes;
    Address from;
    Nanoseconds arrival;
  };

  Nanoseconds turn_;
  Nanoseconds turn_ends_{0};
  std::vector<Datagram> in_turn_;
  std::vector<Datagram> waiting_;
};

}  // namespace forcebound::sim
