#include "tests/tools/relay/relay.hpp"

#include <algorithm>

namespace forcebound::relay {
namespace {

constexpr std::size_t kUdpPayloadMax = 65'535;

// From each link and call, so that a flood on one never delays due packets.
constexpr int kReceivedAtOnceMax = 64;

}  // namespace

Relay::Relay(const RelaySettings& settings, net::DatagramLink& downstream, UpstreamLinks& links,
             PacketObserver* observer)
    : upstream_(settings.upstream),
      flows_max_(settings.flows_max),
      flow_idle_(settings.flow_idle),
      downstream_(downstream),
      links_(links),
      observer_(observer),
      up_(settings.up),
      down_(settings.down),
      buffer_(kUdpPayloadMax) {
  flows_.reserve(flows_max_);
}

void Relay::receive(Nanoseconds now) {
  expire_idle_flows(now);
  receive_from_clients(now);
  for (Flow& flow : flows_) receive_from_server(flow, now);
}

void Relay::receive_from_clients(Nanoseconds now) {
  for (int i = 0; i < kReceivedAtOnceMax; ++i) {
    const auto received = downstream_.receive(buffer_);
    if (!received) return;
    if (Flow* flow = find_or_open(received->from, now)) {
      flow->last_used = now;
      push(Direction::up, now, received->bytes, flow->id);
    } else {
      ++counters_.flow_refused;
    }
  }
}

void Relay::receive_from_server(Flow& flow, Nanoseconds now) {
  for (int i = 0; i < kReceivedAtOnceMax; ++i) {
    const auto received = flow.upstream->receive(buffer_);
    if (!received) return;
    flow.last_used = now;
    push(Direction::down, now, received->bytes, flow.id);
  }
}

void Relay::push(Direction direction, Nanoseconds now, std::size_t bytes, std::uint64_t flow) {
  const auto datagram = std::span(buffer_).first(std::min(bytes, buffer_.size()));
  const netem::Verdicts verdicts = way(direction).push(now, datagram, flow);
  if (observer_ == nullptr) return;
  for (const netem::Verdict& verdict : verdicts) observer_->on_verdict(direction, verdict);
}

void Relay::forward(Nanoseconds now) {
  for (const Direction direction : {Direction::up, Direction::down}) {
    while (forward_one(direction, now)) continue;
  }
}

bool Relay::forward_one(Direction direction, Nanoseconds now) {
  const auto departure = way(direction).pop(now);
  if (!departure) return false;
  send(direction, *departure);
  count_lateness(now - departure->time());
  if (observer_ != nullptr) observer_->on_departure(direction, departure->verdict);
  return true;
}

void Relay::send(Direction direction, const netem::Departure& departure) {
  const Flow* flow = find(departure.tag);
  if (flow == nullptr) {
    ++counters_.orphaned;
    return;
  }
  const bool sent = direction == Direction::up ? flow->upstream->send(departure.bytes, upstream_)
                                               : downstream_.send(departure.bytes, flow->client);
  if (!sent) ++counters_.send_failed;
}

void Relay::count_lateness(Nanoseconds late) noexcept {
  ++lateness_.packets;
  lateness_.total += late;
  lateness_.most = std::max(lateness_.most, late);
  if (late > Lateness::kLate) ++lateness_.late;
}

std::optional<Nanoseconds> Relay::next_departure() const noexcept {
  const auto up = up_.next_departure();
  const auto down = down_.next_departure();
  if (!up || !down) return up ? up : down;
  return std::min(*up, *down);
}

const netem::Impairment& Relay::impairment(Direction direction) const noexcept {
  return direction == Direction::up ? up_ : down_;
}

Relay::Flow* Relay::find_or_open(const Address& client, Nanoseconds now) {
  const auto known = std::find_if(flows_.begin(), flows_.end(), [&](const Flow& f) { return f.client == client; });
  if (known != flows_.end()) return &*known;
  if (flows_.size() == flows_max_) return nullptr;
  net::DatagramLink* const link = links_.open();
  if (link == nullptr) return nullptr;
  ++counters_.flows_opened;
  return &flows_.emplace_back(Flow{next_flow_++, client, link, now});
}

Relay::Flow* Relay::find(std::uint64_t id) noexcept {
  const auto found = std::find_if(flows_.begin(), flows_.end(), [&](const Flow& f) { return f.id == id; });
  return found == flows_.end() ? nullptr : &*found;
}

void Relay::expire_idle_flows(Nanoseconds now) {
  counters_.flows_expired += std::erase_if(flows_, [&](const Flow& flow) {
    const bool idle = now - flow.last_used > flow_idle_;
    if (idle) links_.close(*flow.upstream);
    return idle;
  });
}

}  // namespace forcebound::relay
