#include "forcebound/net/peer_link.hpp"

#include <utility>

namespace forcebound::net {
namespace {

using time::Nanoseconds;

// Left by a peer of before in the socket's buffer.
constexpr int kForeignAtOnce = 64;

UdpLink link_towards(const NameLookup& lookup) {
  if (lookup.is_name()) return UdpLink::towards_nobody();
  const std::vector<Address> addresses = lookup.addresses();
  if (addresses.empty()) throw std::runtime_error(lookup.problem());
  return UdpLink::towards(addresses.front());
}

}  // namespace

PeerLink::PeerLink(NameLookup& lookup, const time::Clock& clock, Found found)
    : lookup_(lookup), clock_(clock), found_(found), link_(link_towards(lookup)), turns_(clock.now()) {
  (void)lookup_.update_turns(seen_, turns_, clock.now());
  if (!lookup_.is_name()) directed_to_ = *turns_.current();
}

void PeerLink::look_up(Nanoseconds now) noexcept {
  if (!lookup_.is_name()) return;
  (void)lookup_.update_turns(seen_, turns_, now);
  if (turns_.look_up_due(now)) lookup_.ask();
}

bool PeerLink::turn_to_current(Nanoseconds now) noexcept {
  for (std::size_t tried = 0; tried < AddressTurns::kAddressesMost; ++tried) {
    const Address* const current = turns_.current();
    if (current == nullptr) return false;
    if (directed_to_ == *current) return true;
    directed_to_.reset();
    if (link_.direct_to(*current)) {
      directed_to_ = *current;
      return true;
    }
    turns_.on_unreachable(now);
  }
  return false;
}

bool PeerLink::send(std::span<const std::byte> datagram, const Address& /*to*/) noexcept {
  const Nanoseconds now = clock_.now();
  look_up(now);
  turns_.before_sending(now);
  if (!turn_to_current(now)) return false;
  const std::uint64_t refused = link_.refused();
  const bool sent = link_.send(datagram, *directed_to_);
  if (link_.refused() != refused) turns_.on_unreachable(now);
  return sent;
}

std::optional<Received> PeerLink::receive(std::span<std::byte> buffer) noexcept {
  const std::uint64_t refused = link_.refused();
  for (int foreign = 0; foreign < kForeignAtOnce; ++foreign) {
    auto received = link_.receive(buffer);
    if (!received) break;
    if (lookup_.is_name() && received->from != directed_to_) continue;
    received->from = kPeer;
    turns_.on_received();
    if (found_ == Found::by_answer) keep();
    return received;
  }
  if (!lookup_.is_name()) return std::nullopt;
  const Nanoseconds now = clock_.now();
  if (link_.refused() != refused) turns_.on_unreachable(now);
  look_up(now);
  return std::nullopt;
}

void PeerLink::keep() noexcept {
  if (!lookup_.is_name() || !directed_to_) return;
  turns_.on_session(clock_.now());
  if (found_at_ != directed_to_) store_found();
}

void PeerLink::store_found() noexcept {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;  // next time
  found_at_ = directed_to_;
  news_ = directed_to_;
}

std::string PeerLink::take_news() {
  std::optional<Address> at;
  {
    const std::scoped_lock lock(mutex_);
    at = std::exchange(news_, std::nullopt);
  }
  return at ? to_string(lookup_.endpoint()) + " is at " + to_string(*at) : std::string();
}

}  // namespace forcebound::net
