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

/// What waits for a server that takes its time: as the program does, it takes in all that has come, computes once, and
/// answers; what comes meanwhile waits for the next turn.
class BusyServer {
 public:
  explicit BusyServer(Nanoseconds turn) : turn_(turn) {}

  /// A datagram comes, at a time that never runs backwards.
  void arrive(std::span<const std::byte> datagram, const Address& from, Nanoseconds now);

  /// When the turn ends that is under way.
  [[nodiscard]] std::optional<Nanoseconds> next_event() const noexcept;

  /// At that time: gives all that this turn is about, in the order it came, and begins the next turn.
  void end_turn(const std::function<void(std::span<const std::byte>, const Address&, Nanoseconds arrival)>& take_in);

  /// It dies, and all that waits with it.
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
