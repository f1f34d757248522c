#include "forcebound/server/security/secure_link.hpp"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <utility>
#include <variant>

#include "forcebound/server/session/shared_limits.hpp"

namespace forcebound::server {
namespace {

// Cookies cost little, so that a flood from forged addresses leaves some to others.
constexpr Nanoseconds kUnreachedInterval = std::chrono::milliseconds{1};
constexpr int kUnreachedAtOnce = 200;
constexpr Nanoseconds kHandshakeInterval = std::chrono::milliseconds{100};
constexpr int kHandshakesAtOnce = 30;
// So many are told why they do not come in that it takes a hundredth of the thread's time.
constexpr Nanoseconds kUnprovenInterval = std::chrono::seconds{1};
constexpr int kUnprovenAtOnce = 5;
constexpr Nanoseconds kAllUnprovenInterval = std::chrono::milliseconds{10};
constexpr int kAllUnprovenAtOnce = 10;
// Of an address, where another client was heard.
constexpr Nanoseconds kOwnsAfterSilence = std::chrono::seconds{1};

// Datagrams without content that one call of `receive` drops at most.
constexpr int kDroppedAtOnce = 64;

constexpr std::string_view kEncryptionWanted =
    "this server takes encrypted sessions alone: start the client with --server-key or --known-servers and --key, or "
    "with --psk, as its owner says";

ServerKeys checked(ServerKeys keys) {
  if (!keys.own && !keys.shared) throw std::invalid_argument("encryption needs a key pair or a shared key");
  return keys;
}

/// With those that move here from other workers, and its own that come back: others have taken their places meanwhile.
std::size_t peers_most(const SecureLimits& limits) noexcept {
  const std::size_t moved_most = limits.moved == nullptr ? 0 : limits.moved->most();
  return limits.confirmed_most() + SecureLink::kUnconfirmedMost + 2 * moved_most;
}

/// A quarter of the thread's time, and not so many at once that a motion waits longer for them than for a handshake.
time::TokenBucket judgements_of(const RequestJudge& judge, Nanoseconds now) {
  constexpr Nanoseconds kHash{30};
  constexpr int kShare = 4;
  constexpr int kHashesAtOnce = 8192;
  const int hashes = static_cast<int>(judge.hashes());
  return {kShare * hashes * kHash, std::max(1, kHashesAtOnce / hashes), now};
}

}  // namespace

SecureLink::SecureLink(ServerKeys keys, const SecureLimits& limits, net::DatagramLink& link, const time::Clock& clock,
                       FillRandom fill_random, ServerObserver* observer)
    : keys_(checked(std::move(keys))),
      limits_(limits),
      link_(link),
      clock_(clock),
      fill_random_(std::move(fill_random)),
      observer_(observer == nullptr ? nobody_ : *observer),
      owners_(peers_most(limits), random<std::uint64_t>()),
      cookies_(random_key()),
      unreached_(kUnreachedInterval * limits.workers, std::max(1, kUnreachedAtOnce / static_cast<int>(limits.workers)),
                 clock.now(), random<std::uint64_t>()),
      judge_(keys_),
      judgements_(judgements_of(judge_, clock.now())),
      handshakes_(kHandshakeInterval, kHandshakesAtOnce),
      unproven_(kUnprovenInterval, kUnprovenAtOnce),
      all_unproven_(kAllUnprovenInterval, kAllUnprovenAtOnce, clock.now()) {
  peers_.reserve(peers_most(limits));  // what moves here needs no memory
}

security::SecretKey SecureLink::random_key() {
  security::SecretKey key;
  fill_random_(*key);
  return key;
}

SecureLink::~SecureLink() { security::wipe(plain_.data(), plain_.size()); }

std::optional<SecureLink::Content> SecureLink::accept(std::span<const std::byte> datagram, const net::Address& from,
                                                      Nanoseconds now) noexcept {
  try {
    if (security::is_record(datagram)) return open_record(datagram, from, now);
    if (security::is_handshake(datagram)) {
      on_request(datagram, from, now);
    } else {
      receive_clear(datagram, from, now);
    }
  } catch (const std::exception&) {  // no memory or no randomness: whoever asked asks again
    ++counters_.handshakes_failed;
  }
  return std::nullopt;
}

std::optional<SecureLink::Content> SecureLink::open_record(std::span<const std::byte> record, const net::Address& from,
                                                           Nanoseconds now) {
  const auto found = peers_.find(security::session_of_record(record));
  if (found == peers_.end()) {
    ++counters_.records[security::Opening::other_session];
    return std::nullopt;
  }
  auto& [number, peer] = *found;
  const security::Opened opened = peer.channel.open(record, plain_, now);
  ++counters_.records[opened.result];
  if (opened.result != security::Opening::opened) return std::nullopt;
  peer.received = now;
  if (!peer.confirmed) confirm(found);
  assign_address(number, peer, from, now);
  const auto content = std::span<const std::byte>(plain_).first(opened.bytes);
  if (security::is_handshake(content)) {
    on_later_request(number, opened, content, from);
    return std::nullopt;
  }
  return Content{.bytes = content, .client = peer.client, .keys = number};
}

void SecureLink::assign_address(std::uint32_t number, Peer& peer, const net::Address& from, Nanoseconds now) noexcept {
  if (may_own(from, number, peer, now)) {
    owners_.assign(number, peer.places, from);
  } else {
    ++counters_.addresses_of_others;
  }
}

SecureLink::MovedOut SecureLink::move_out(std::uint32_t keys, std::size_t worker, Nanoseconds now,
                                          const Give& give) noexcept {
  const auto found = peers_.find(keys);
  if (limits_.moved == nullptr || found == peers_.end()) return MovedOut::not_taken;
  if (!found->second.moves.take(now)) return MovedOut::too_often;
  // Before: the next record may follow at once. What goes home is noted there: an entry for it may be needed again.
  const bool goes_home = WorkerPlace::owner_of(keys, limits_.workers) == worker;
  const security::PublicKey* const client = keys_.own ? &found->second.key : nullptr;
  if (!goes_home && !limits_.moved->store(keys, worker, client)) return MovedOut::too_many;
  const RecentAddresses places = std::exchange(found->second.places, {});
  Moving moving(peers_.extract(found));
  if (!give(moving)) {
    moving.node_.mapped().places = places;
    peers_.insert(std::move(moving.node_));
    if (!goes_home) (void)limits_.moved->store(keys, limits_.worker);
    return MovedOut::not_taken;
  }
  owners_.forget(keys, places);
  --confirmed_;  // as all are of which something was opened
  from_elsewhere_ -= is_from_elsewhere(keys) ? 1 : 0;
  return MovedOut::moved;
}

std::optional<const security::AllowedClient*> SecureLink::move_in(Moving moving, const net::Address& from,
                                                                  Nanoseconds now) noexcept {
  const std::uint32_t number = moving.node_.key();
  Peer& peer = moving.node_.mapped();
  peer.client = has_list() ? keys_.clients->find(peer.key) : nullptr;
  if (has_list() && peer.client == nullptr) {
    limits_.moved->forget(number);
    return std::nullopt;
  }
  (void)limits_.moved->store(number, limits_.worker);
  const auto inserted = peers_.insert(std::move(moving.node_));
  from_elsewhere_ += is_from_elsewhere(number) ? 1 : 0;
  confirm(inserted.position);
  assign_address(number, inserted.position->second, from, now);
  return inserted.position->second.client;
}

std::optional<std::size_t> SecureLink::moved_to(std::span<const std::byte> record) const noexcept {
  if (limits_.moved == nullptr || !security::is_record(record)) return std::nullopt;
  const std::uint32_t number = security::session_of_record(record);
  return peers_.contains(number) ? std::nullopt : limits_.moved->worker_of(number);
}

bool SecureLink::is_from_elsewhere(std::uint32_t number) const noexcept {
  return WorkerPlace::owner_of(number, limits_.workers) != limits_.worker;
}

bool SecureLink::is_full() const noexcept { return confirmed_ - from_elsewhere_ >= limits_.confirmed_most(); }

void SecureLink::confirm(Peers::iterator peer) noexcept {
  peer->second.confirmed = true;
  ++confirmed_;
  if (peer->second.client != nullptr) keep_to_most_of(*peer->second.client, peer);
}

void SecureLink::keep_to_most_of(const security::AllowedClient& client, Peers::iterator newest) noexcept {
  if (!client.sessions_max) return;
  std::size_t held = 1;
  auto oldest = peers_.end();
  for (auto peer = peers_.begin(); peer != peers_.end(); ++peer) {
    if (peer == newest || !peer->second.confirmed || peer->second.client != &client) continue;
    ++held;
    if (oldest == peers_.end() || peer->second.received < oldest->second.received) oldest = peer;
  }
  if (held <= SecureLimits::confirmed_most_of(*client.sessions_max)) return;
  ++counters_.sessions_idle;
  forget(oldest);
}

/// Not if another client was just heard from there: who forges its address would get what is meant for it.
bool SecureLink::may_own(const net::Address& address, std::uint32_t number, const Peer& peer,
                         Nanoseconds now) const noexcept {
  const auto owner = owners_.find(address);
  if (!owner || *owner == number || !keys_.own) return true;
  const auto other = peers_.find(*owner);
  return other == peers_.end() || other->second.key == peer.key || now - other->second.received > kOwnsAfterSilence;
}

void SecureLink::receive_clear(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now) {
  ++counters_.in_clear;
  const auto checked_heading = wire::heading_of(datagram);
  const auto* const heading = std::get_if<wire::Heading>(&checked_heading);
  if (heading == nullptr || !heading->is<wire::Hello>() || !unreached_.take(from, now)) return;
  const auto decoded = codec_.decode(datagram, *heading);
  const auto* const message = std::get_if<wire::Message>(&decoded);
  const auto* const hello = message == nullptr ? nullptr : std::get_if<wire::Hello>(message);
  if (hello == nullptr) return;
  const auto refusal = codec_.encode(wire::Refusal{.client_nonce = hello->client_nonce,
                                                   .reason = wire::RefusalReason::encryption_wanted,
                                                   .text = kEncryptionWanted});
  if (refusal.size() > datagram.size()) return;
  ++counters_.hellos_in_clear;
  link_.send(refusal, from);
  observer_.on_refused(from, "its client does not encrypt");
}

bool SecureLink::send(std::span<const std::byte> datagram, const net::Address& to) noexcept {
  const auto owner = owners_.find(to);
  const auto found = owner ? peers_.find(*owner) : peers_.end();
  if (found == peers_.end()) return false;
  const auto bytes = found->second.channel.seal(datagram, sealed_, clock_.now());
  return bytes && link_.send(std::span(sealed_).first(*bytes), to);
}

std::optional<net::Received> SecureLink::receive(std::span<std::byte> buffer) noexcept {
  std::array<std::byte, net::kDatagramBytesMax> datagram;
  for (int dropped = 0; dropped < kDroppedAtOnce; ++dropped) {
    const auto received = link_.receive(datagram);
    if (!received) {
      while (has_waiting()) answer_waiting(clock_.now());
      return std::nullopt;
    }
    const auto there = std::span(datagram).first(std::min(received->bytes, datagram.size()));
    const auto content = accept(there, received->from, clock_.now());
    if (!content) continue;
    std::ranges::copy(content->bytes.first(std::min(content->bytes.size(), buffer.size())), buffer.begin());
    return net::Received{.bytes = content->bytes.size(), .from = received->from, .waited = received->waited};
  }
  return std::nullopt;
}

void SecureLink::replace_clients(security::AllowedClients clients) {
  if (!keys_.clients) return;
  keys_.clients = std::move(clients);
  judge_.replace(keys_);
  judgements_ = judgements_of(judge_, clock_.now());
  for (auto next = peers_.begin(); next != peers_.end();) {
    const auto peer = next++;
    peer->second.client = keys_.clients->find(peer->second.key);
    if (peer->second.client == nullptr) forget(peer);
  }
}

void SecureLink::on_timer(Nanoseconds now) noexcept {
  for (auto next = peers_.begin(); next != peers_.end();) {
    const auto peer = next++;
    const bool confirmed = peer->second.confirmed;
    const Nanoseconds kept = confirmed ? limits_.idle_timeout + kKeptAfterIdle : kUnconfirmedKept;
    peer->second.channel.wipe_expired(now);
    const bool expired = confirmed && !peer->second.channel.can_seal(now);
    if (!expired && now - peer->second.received < kept) continue;
    ++(confirmed ? counters_.sessions_idle : counters_.handshakes_unused);
    forget(peer);
  }
}

void SecureLink::forget(Peers::iterator peer) noexcept {
  owners_.forget(peer->first, peer->second.places);
  confirmed_ -= peer->second.confirmed ? 1 : 0;
  if (is_from_elsewhere(peer->first)) {
    --from_elsewhere_;
    limits_.moved->forget(peer->first);
  }
  peers_.erase(peer);
}

}  // namespace forcebound::server
