#pragma once

#include <cstddef>

#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/netem/random.hpp"
#include "tests/tools/netem/trace.hpp"

namespace forcebound::netem {

/// Lets packets leave only at slot times, `netem slot`.
///
/// The first slot is at the origin, each next one a drawn time later. A packet leaves in the first slot that is not
/// before it is ready and that still has room; one that is larger than a slot's bytes leaves in a slot of its own.
/// Allocates nothing.
class Slots {
 public:
  Slots(const Slot& slot, Nanoseconds origin) noexcept : slot_(slot), opens_(origin) {}

  /// When the packet leaves. Packets come in the order in which they are ready.
  Nanoseconds pass(Nanoseconds ready, std::size_t bytes, Random& random) noexcept;

 private:
  void open_next(Random& random) noexcept;
  [[nodiscard]] bool has_room(std::size_t bytes) const noexcept;

  Slot slot_;
  Nanoseconds opens_;
  std::uint64_t packets_used_ = 0;
  std::uint64_t bytes_used_ = 0;
};

/// Lets packets leave at the delivery opportunities of a mahimahi trace: each carries 1500 bytes, of several small
/// packets or of a part of a large one, and an unused one is lost.
///
/// Allocates nothing after construction.
class DeliveryOpportunities {
 public:
  DeliveryOpportunities(DeliveryTrace trace, Nanoseconds origin) noexcept
      : trace_(std::move(trace)), cycle_begin_(origin) {}

  /// When the packet's last byte leaves. Packets come in the order in which they are ready.
  Nanoseconds pass(Nanoseconds ready, std::size_t bytes) noexcept;

 private:
  [[nodiscard]] Nanoseconds current() const noexcept;
  void skip_to(Nanoseconds ready) noexcept;
  void advance() noexcept;

  DeliveryTrace trace_;
  Nanoseconds cycle_begin_;
  std::size_t index_ = 0;
  std::size_t bytes_left_ = DeliveryTrace::kOpportunityBytes;
};

}  // namespace forcebound::netem
