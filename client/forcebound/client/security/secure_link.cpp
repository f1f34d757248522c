#include "forcebound/client/security/secure_link.hpp"

#include <algorithm>

namespace forcebound::client {

SecureLink::SecureLink(net::DatagramLink& link, const net::Address& server, Handshaker& handshaker,
                       const time::Clock& clock)
    : link_(link), server_(server), handshaker_(handshaker), clock_(clock) {
  handshaker_.want(wanted(clock_.now()), 0);
}

bool SecureLink::ready() const noexcept { return newest().can_seal(clock_.now()); }

bool SecureLink::send(std::span<const std::byte> datagram, const net::Address& /*to*/) noexcept {
  const auto sealed = seal(datagram);
  return !sealed.empty() && link_.send(sealed, server_);
}

std::span<const std::byte> SecureLink::seal(std::span<const std::byte> content) noexcept {
  const Nanoseconds now = clock_.now();
  const auto sealed = seal_unanswered(content, now);
  if (sealed.empty()) return sealed;
  if (unanswered_ == 0) unanswered_since_ = now;
  unanswered_ = std::min(unanswered_ + 1, kUnansweredLeast);
  return sealed;
}

std::span<const std::byte> SecureLink::seal_unanswered(std::span<const std::byte> content, Nanoseconds now) noexcept {
  return std::span(sealed_).first(newest().seal(content, sealed_, now).value_or(0));
}

std::optional<net::Received> SecureLink::receive(std::span<std::byte> buffer) noexcept {
  exchange();
  for (int cost = 0; cost < kCostMost; ++cost) {
    auto received = link_.receive(received_);
    if (!received) return std::nullopt;
    const auto datagram = std::span(received_).first(std::min(received->bytes, received_.size()));
    if (received->from != server_) continue;
    const std::uint64_t forged = counters_.by_opening[security::Opening::not_authentic];
    if (const auto bytes = open(datagram, buffer)) {
      received->bytes = *bytes;
      return received;
    }
    if (counters_.by_opening[security::Opening::not_authentic] > forged) cost += kForgedCost;
  }
  return std::nullopt;
}

std::optional<std::size_t> SecureLink::open(std::span<const std::byte> datagram, std::span<std::byte> buffer) noexcept {
  if (security::is_handshake(datagram)) {
    counters_.handshakes_dropped += !handshaker_.receive(datagram);
    return std::nullopt;
  }
  if (!security::is_record(datagram)) {
    ++counters_.in_clear;
    return std::nullopt;
  }
  const Nanoseconds now = clock_.now();
  const bool is_newest = security::session_of_record(datagram) == newest().numbers().own;
  security::Channel& channel = is_newest ? newest() : channels_[1 - newest_];
  const security::Opened opened = channel.open(datagram, buffer, now);
  ++counters_.by_opening[opened.result];
  if (opened.result != security::Opening::opened) return std::nullopt;
  if (is_newest) {
    any_opened_ = true;
    unanswered_ = 0;
  }
  const auto content = buffer.first(opened.bytes);
  if (!security::is_handshake(content)) return opened.bytes;
  if (is_newest) (void)handshaker_.receive(content);
  return std::nullopt;
}

void SecureLink::exchange() noexcept {
  const Nanoseconds now = clock_.now();
  for (security::Channel& channel : channels_) channel.wipe_expired(now);
  const auto made = handshaker_.made();
  if (made) install_keys(*made, now);
  handshaker_.want(wanted(now), newest().handshake());
  if (made) handshaker_.keys_taken();
  while (handshaker_.take(outgoing_)) {
    const auto bytes = std::span<const std::byte>(outgoing_.bytes).first(outgoing_.length);
    const auto datagram = outgoing_.sealed ? seal_unanswered(bytes, now) : bytes;
    if (!datagram.empty()) (void)link_.send(datagram, server_);
  }
}

void SecureLink::install_keys(const Handshaker::Made& made, Nanoseconds now) noexcept {
  if (made.of_new_session) {
    newest().end_by(now + security::kOldKeyKept);
    newest_ = 1 - newest_;
    newest().begin(made.numbers);
    any_opened_ = false;
    ++counters_.sessions;
  } else {
    ++counters_.rekeys;
  }
  // False only for a number that is in use, which the handshaker does not ask for.
  (void)newest().install(made.handshake, *made.keys, security::Role::initiator, now);
  unanswered_ = 0;
}

Handshaker::Wanted SecureLink::wanted(Nanoseconds now) const noexcept {
  if (!newest().can_seal(now) || is_unanswered(now)) return Handshaker::Wanted::session;
  return newest().wants_rekey(now) ? Handshaker::Wanted::next_key : Handshaker::Wanted::nothing;
}

bool SecureLink::is_unanswered(Nanoseconds now) const noexcept {
  return unanswered_ >= kUnansweredLeast && now - unanswered_since_ >= (any_opened_ ? kSilence : kFirstSilence);
}

}  // namespace forcebound::client
