#include "tests/tools/netem/impairment.hpp"

#include <algorithm>
#include <utility>

namespace forcebound::netem {
namespace {

template <class T>
std::optional<T> trace_of(const std::optional<NetworkTrace>& trace) {
  if (!trace || !std::holds_alternative<T>(*trace)) return std::nullopt;
  return std::get<T>(*trace);
}

}  // namespace

std::uint64_t direction_seed(std::uint64_t seed, Direction direction) noexcept {
  // SplitMix64's step, so that neighbouring seeds are independent.
  std::uint64_t x = seed + (direction == Direction::up ? 1U : 2U) * 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

// Members are made in the order of their declaration, and so are the first draws.
Impairment::Impairment(const ImpairmentSettings& settings)
    : netem_(settings.netem),
      rtt_trace_(trace_of<RttTrace>(settings.trace)),
      blackholes_(settings.blackholes),
      origin_(settings.origin),
      limit_packets_(limit_packets()),
      random_(settings.seed),
      delay_distribution_(netem_.delay, random_),
      loss_(netem_.loss, random_),
      duplicate_(netem_.duplicate, random_),
      corrupt_(netem_.corrupt, random_),
      reorder_(netem_.reorder.chance, random_),
      slots_(netem_.slot, settings.origin) {
  if (auto schedule = trace_of<DeliveryTrace>(settings.trace))
    opportunities_.emplace(*std::move(schedule), settings.origin);
}

std::uint32_t Impairment::limit_packets() const noexcept {
  return netem_.limit_packets.value_or(rtt_trace_ ? kTracedLimitPackets : kLimitPackets);
}

void Impairment::change(Nanoseconds now, const NetemParameters& netem) {
  settle(now);
  netem_ = netem;
  limit_packets_ = limit_packets();
  delay_distribution_ = DelayDistribution(netem.delay, random_);
  loss_ = LossModel(netem.loss, random_);
  duplicate_ = Event(netem.duplicate, random_);
  corrupt_ = Event(netem.corrupt, random_);
  reorder_ = Event(netem.reorder.chance, random_);
  slots_ = Slots(netem.slot, now);
  delayed_since_reordered_ = 0;
}

Verdicts Impairment::push(Nanoseconds now, std::span<const std::byte> bytes, std::uint64_t tag) {
  settle(now);
  ++counters_.received;
  Verdicts verdicts;
  std::optional<Nanoseconds> trace_delay{0};
  if (rtt_trace_) trace_delay = rtt_trace_->one_way_delay(now - origin_);
  if (!trace_delay || in_blackhole(now)) {
    ++counters_.blackout;
    verdicts.add({.number = counters_.received, .fate = Fate::blackout, .arrival = now});
    return verdicts;
  }
  admit({now, bytes, tag, *trace_delay, false}, verdicts);
  return verdicts;
}

bool Impairment::in_blackhole(Nanoseconds now) const noexcept {
  const Nanoseconds time = now - origin_;
  return std::any_of(blackholes_.begin(), blackholes_.end(),
                     [time](const Blackhole& hole) { return hole.from <= time && time < hole.to; });
}

void Impairment::admit(const Arrival& arrival, Verdicts& verdicts) {
  WaitingPacket packet{.verdict = {.number = counters_.received, .copy = arrival.copy, .arrival = arrival.now},
                       .tag = arrival.tag,
                       .bytes = arrival.bytes.size()};
  int packets = 1;
  if (!arrival.copy && duplicate_.happens(random_)) ++packets;
  if (loss_.loses_next(random_)) --packets;
  if (packets == 0) {
    ++counters_.lost;
    packet.verdict.fate = Fate::lost;
    verdicts.add(packet.verdict);
    return;
  }

  packet.buffer = buffers_.store(arrival.bytes);
  if (corrupt_.happens(random_) && !arrival.bytes.empty()) {
    corrupt(buffers_[packet.buffer]);
    packet.verdict.corrupted = true;
    ++counters_.corrupted;
  }
  if (waiting() >= limit_packets_) {
    buffers_.release(packet.buffer);
    ++counters_.over_limit;
    packet.verdict.fate = Fate::over_limit;
    verdicts.add(packet.verdict);
    return;
  }
  if (packets == 2) {
    ++counters_.duplicated;
    Arrival copy = arrival;
    copy.copy = true;
    admit(copy, verdicts);
  }
  if (goes_at_once()) {
    send_at_once(packet);
  } else {
    delay(packet, arrival);
  }
  verdicts.add(packet.verdict);
}

void Impairment::corrupt(std::span<std::byte> bytes) noexcept {
  const std::size_t index = random_.draw() * std::uint64_t{bytes.size()} >> 32U;
  bytes[index] ^= std::byte{1} << (random_.draw() % 8);
}

bool Impairment::goes_at_once() noexcept {
  const std::uint32_t gap = netem_.reorder.gap;
  return gap != 0 && delayed_since_reordered_ >= gap - 1 && reorder_.happens(random_);
}

void Impairment::send_at_once(WaitingPacket& packet) {
  delayed_since_reordered_ = 0;
  ++counters_.reordered;
  packet.verdict.reordered = true;
  packet.departure = Nanoseconds::min();  // before all other due packets
  leaving_.push(packet, --first_turn_);
}

void Impairment::delay(WaitingPacket& packet, const Arrival& arrival) {
  ++delayed_since_reordered_;
  Nanoseconds ready = arrival.now + delay_distribution_.next(random_) + arrival.trace_delay;
  if (netem_.rate.bits_per_second != 0) {
    // After the last packet that still waits; once it has left, the line is free.
    if (last_ready_ > arrival.now) ready = std::max(ready, last_ready_);
    ready += transmission_time(packet.bytes);
  }
  // Bounds the wait, so that sums stay within 64 bits.
  constexpr Nanoseconds kDelayMost = std::chrono::hours{24 * 365};
  packet.departure = std::clamp(ready, arrival.now, arrival.now + kDelayMost);
  packet.verdict.delay = packet.departure - arrival.now;
  last_ready_ = std::max(last_ready_, packet.departure);
  delayed_.push(packet, next_turn_++);
}

Nanoseconds Impairment::transmission_time(std::size_t payload_bytes) const noexcept {
  const Rate& rate = netem_.rate;
  std::int64_t bytes =
      static_cast<std::int64_t>(payload_bytes + kIpUdpHeaderBytes + kEthernetHeaderBytes) + rate.packet_overhead_bytes;
  if (rate.cell_bytes != 0) {
    const std::int64_t cells = (std::max<std::int64_t>(bytes, 0) + rate.cell_bytes - 1) / rate.cell_bytes;
    bytes = cells * (std::int64_t{rate.cell_bytes} + rate.cell_overhead_bytes);
  }
  const auto bits = static_cast<std::uint64_t>(std::max<std::int64_t>(bytes, 0)) * 8;
  // Whole seconds and the rest apart, so that no product leaves 64 bits.
  const std::uint64_t seconds = bits / rate.bits_per_second;
  const std::uint64_t nanoseconds = bits % rate.bits_per_second * 1'000'000'000U / rate.bits_per_second;
  return std::chrono::seconds(seconds) + Nanoseconds{static_cast<std::int64_t>(nanoseconds)};
}

void Impairment::settle(Nanoseconds now) {
  while (!delayed_.empty() && delayed_.front().departure <= now) {
    WaitingPacket packet = delayed_.pop();
    packet.departure = held_back_until(packet);
    packet.verdict.delay = packet.departure - packet.verdict.arrival;
    leaving_.push(packet, next_turn_++);
  }
}

Nanoseconds Impairment::held_back_until(const WaitingPacket& packet) noexcept {
  const std::size_t ip_bytes = packet.bytes + kIpUdpHeaderBytes;
  const Nanoseconds slot = slots_.pass(packet.departure, ip_bytes + kEthernetHeaderBytes, random_);
  return opportunities_ ? opportunities_->pass(slot, ip_bytes) : slot;
}

std::optional<Departure> Impairment::pop(Nanoseconds now) {
  if (popped_buffer_) buffers_.release(*popped_buffer_);
  popped_buffer_.reset();
  settle(now);
  if (leaving_.empty() || leaving_.front().departure > now) return std::nullopt;
  const WaitingPacket packet = leaving_.pop();
  popped_buffer_ = packet.buffer;
  ++counters_.forwarded;
  return Departure{packet.verdict, packet.tag, buffers_[packet.buffer]};
}

std::optional<Nanoseconds> Impairment::next_departure() const noexcept {
  if (!leaving_.empty()) {
    const Verdict& front = leaving_.front().verdict;
    return front.arrival + front.delay;
  }
  if (!delayed_.empty()) return delayed_.front().departure;
  return std::nullopt;
}

}  // namespace forcebound::netem
