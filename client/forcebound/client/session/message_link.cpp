#include "forcebound/client/session/message_link.hpp"

#include <algorithm>

namespace forcebound::client {
namespace {

constexpr int kDecodedPerTickMax = 64;
// Those that are dropped by their address or heading cost little. If they counted, a flood of them would make all that
// are not dropped wait.
constexpr int kDroppedPerTickMax = 512;

}  // namespace

bool MessageLink::send(const wire::Message& message) noexcept {
  const bool sent = datagrams_.send(codec_.encode(message), server_);
  if (!sent) ++counts_.send_failures;
  return sent;
}

std::optional<MessageLink::Arrival> MessageLink::receive(const Connection& connection, Received& in_tick) noexcept {
  while (in_tick.decoded < kDecodedPerTickMax && in_tick.dropped < kDroppedPerTickMax) {
    const auto received = datagrams_.receive(buffer_);
    if (!received) return std::nullopt;
    // Waited until now, which is later than the tick's time by the reading and the sending.
    const Nanoseconds arrival = clock_.now() - received->waited;
    if (received->from != server_) {
      count_foreign();
      ++in_tick.dropped;
      continue;
    }
    const auto datagram = std::span(buffer_).first(std::min(received->bytes, buffer_.size()));
    const auto heading = heading_of(datagram, connection);
    if (!heading) {
      ++in_tick.dropped;
      continue;
    }
    ++in_tick.decoded;
    decoded_ = codec_.decode(datagram, *heading);
    if (const auto* message = std::get_if<wire::Message>(&decoded_)) return Arrival{*message, arrival};
    ++counts_.malformed[std::get<wire::Malformed>(decoded_)];
  }
  return std::nullopt;
}

std::optional<wire::Heading> MessageLink::heading_of(std::span<const std::byte> datagram,
                                                     const Connection& connection) noexcept {
  const auto read = wire::heading_of(datagram);
  if (const auto* reason = std::get_if<wire::Malformed>(&read)) {
    ++counts_.malformed[*reason];
    return std::nullopt;
  }
  const auto& heading = std::get<wire::Heading>(read);
  if (heading.is<wire::Hello>() || heading.is<wire::MotionSample>()) {
    ++counts_.malformed[wire::Malformed::unreadable];
    return std::nullopt;
  }
  if (heading.kind < std::variant_size_v<wire::Message> && !connection.is_for_us(heading)) {
    count_foreign();
    return std::nullopt;
  }
  return heading;
}

}  // namespace forcebound::client
