#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tests/tools/netem/delay_distribution.hpp"
#include "tests/tools/netem/loss_model.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/netem/packet_queue.hpp"
#include "tests/tools/netem/random.hpp"
#include "tests/tools/netem/slots.hpp"
#include "tests/tools/netem/trace.hpp"
#include "tests/tools/netem/verdict.hpp"

namespace forcebound::netem {

/// Headers of a payload on an IPv4 Ethernet link; `rate` and `slot` count them, to agree with a real link.
inline constexpr std::size_t kEthernetHeaderBytes = 14;
inline constexpr std::size_t kIpUdpHeaderBytes = 28;

/// A time, since the origin, in which a direction is dead: what is sent in [from, to) is lost.
struct Blackhole {
  Nanoseconds from{0};
  Nanoseconds to{0};
};

struct ImpairmentSettings {
  NetemParameters netem{};
  std::optional<NetworkTrace> trace{};  ///< its delay or its delivery opportunities come on top of `netem`
  std::vector<Blackhole> blackholes{};
  std::uint64_t seed = 1;
  Nanoseconds origin{0};  ///< when the trace and the slots begin, and blackholes count from
};

/// The seed of one direction, from one seed for both.
std::uint64_t direction_seed(std::uint64_t seed, Direction direction) noexcept;

/// A packet that leaves. `bytes` is valid until the next `pop`.
struct Departure {
  Verdict verdict;  ///< with its actual delay
  std::uint64_t tag;
  std::span<const std::byte> bytes;
  [[nodiscard]] Nanoseconds time() const noexcept { return verdict.arrival + verdict.delay; }
};

/// One direction of a bad network: netem's algorithm, with all its randomness from one seed.
///
/// A packet sent into a blackhole, or into a hole of the trace, is lost without any draw. For each other packet, in
/// this order: the draw for a duplicate; the draw for loss, which of a duplicated packet only cancels the copy; the
/// copy is taken; one bit of one byte flips if the draw for corruption says so; a full queue drops the packet (and its
/// copy); the copy goes through the same again, except for duplication; then the packet is reordered, which means that
/// it leaves at once and first, or delayed. Packets leave in the order of their times.
///
/// Same parameters, seed, times and bytes: same trace, byte for byte, on every machine.
///
/// Time never runs backwards between calls; pop what is due before pushing, since it still fills the queue. In steady
/// running nothing allocates. Not thread-safe.
class Impairment {
 public:
  explicit Impairment(const ImpairmentSettings& settings);

  /// Other parameters for packets that come from now on. Draws go on with the same randomness, so that the same seed
  /// and the same changes at the same times give the same fates; correlations and states of loss begin anew, slots at
  /// `now`. Packets that wait keep their delays; trace and blackholes stay. Allocates.
  void change(Nanoseconds now, const NetemParameters& netem);

  /// A packet arrives. `tag` is returned with its departures.
  Verdicts push(Nanoseconds now, std::span<const std::byte> bytes, std::uint64_t tag = 0);

  /// The next packet that is due, or nothing.
  std::optional<Departure> pop(Nanoseconds now);

  /// When to ask `pop` again. With slots or delivery opportunities it may be too early once, never too late.
  [[nodiscard]] std::optional<Nanoseconds> next_departure() const noexcept;

  [[nodiscard]] const ImpairmentCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] std::size_t waiting() const noexcept { return delayed_.size() + leaving_.size(); }

 private:
  struct Arrival {
    Nanoseconds now;
    std::span<const std::byte> bytes;
    std::uint64_t tag;
    Nanoseconds trace_delay;
    bool copy;
  };

  [[nodiscard]] std::uint32_t limit_packets() const noexcept;
  [[nodiscard]] bool in_blackhole(Nanoseconds now) const noexcept;
  void admit(const Arrival& arrival, Verdicts& verdicts);
  void corrupt(std::span<std::byte> bytes) noexcept;
  bool goes_at_once() noexcept;
  void send_at_once(WaitingPacket& packet);
  void delay(WaitingPacket& packet, const Arrival& arrival);
  void settle(Nanoseconds now);
  Nanoseconds held_back_until(const WaitingPacket& packet) noexcept;
  [[nodiscard]] Nanoseconds transmission_time(std::size_t payload_bytes) const noexcept;

  NetemParameters netem_;
  std::optional<RttTrace> rtt_trace_;
  std::vector<Blackhole> blackholes_;
  Nanoseconds origin_;
  std::uint32_t limit_packets_;
  Random random_;
  DelayDistribution delay_distribution_;
  LossModel loss_;
  Event duplicate_;
  Event corrupt_;
  Event reorder_;
  Slots slots_;
  std::optional<DeliveryOpportunities> opportunities_;

  PacketBuffers buffers_;
  PacketQueue delayed_;  // by the time at which they are ready
  PacketQueue leaving_;  // ready ones, by turn: their departures are final
  std::int64_t next_turn_ = 0;
  std::int64_t first_turn_ = 0;  // of packets that go ahead, counting down
  std::uint32_t delayed_since_reordered_ = 0;
  Nanoseconds last_ready_ = Nanoseconds::min();
  std::optional<std::size_t> popped_buffer_;
  ImpairmentCounters counters_;
};

}  // namespace forcebound::netem
