// The link's answers to handshakes: whose client gets keys.

#include <algorithm>
#include <exception>
#include <map>
#include <new>
#include <string>
#include <utility>
#include <variant>

#include "forcebound/server/security/secure_link.hpp"
#include "forcebound/server/session/shared_limits.hpp"
#include "forcebound/server/session/source_buckets.hpp"

namespace forcebound::server {
namespace {

using security::HandshakeRequest;
using security::HandshakeResult;
using security::Verdict;

// Of a session: a client wants another key every two minutes, and repeats its request while it is not answered.
constexpr Nanoseconds kLaterInterval = std::chrono::seconds{1};
constexpr int kLaterAtOnce = 5;
// Of a session of keys: to the worker of a shared scene, and to that of its session after a silence.
constexpr Nanoseconds kMoveInterval = std::chrono::seconds{1};
constexpr int kMovesAtOnce = 5;
// Of a client of the list. More wait until one of these is confirmed or forgotten.
constexpr std::size_t kUnconfirmedOfClient = 2;
// Copies and what has been overtaken cost little.
constexpr int kLooksAtOnce = 16;

/// The bytes that name an address to cookies.
std::array<std::byte, 18> named(const net::Address& address) noexcept {
  constexpr unsigned kByteBits = 8;
  std::array<std::byte, 18> bytes{};
  std::ranges::copy(std::as_bytes(std::span(address.ip)), bytes.begin());
  bytes[address.ip.size()] = static_cast<std::byte>(address.port >> kByteBits);
  bytes[address.ip.size() + 1] = static_cast<std::byte>(address.port & 0xffU);
  return bytes;
}

}  // namespace

void SecureLink::on_request(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now) {
  const auto parsed = security::read_handshake(datagram);
  const auto* const request = std::get_if<HandshakeRequest>(&parsed);
  if (request == nullptr || datagram.size() != security::kRequestBytes) {
    ++counters_.handshakes_malformed;
  } else if (!fits(request->topic) || !cookies_.is_good(request->cookie, named(from), now)) {
    offer_cookie(request->topic, from, now);
  } else if (!judgements_.take(now)) {
    ++counters_.handshakes_over_rate;
  } else {
    judge(*request, from, now);
  }
}

void SecureLink::judge(const HandshakeRequest& request, const net::Address& from, Nanoseconds now) noexcept {
  const auto charged = judge_.judge(request, from);
  counters_.handshakes_not_proven += charged ? 0 : 1;
  const std::uint64_t who = charged.value_or(source_of(from));
  const bool in_time = charged ? handshakes_.take(who, now) : unproven_.take(who, now) && all_unproven_.take(now);
  if (!in_time) {
    ++counters_.handshakes_over_rate;
    return;
  }
  Waiting waiting{.from = from, .who = who, .proven = charged.has_value()};
  put(waiting, request);
}

void SecureLink::on_later_request(std::uint32_t keys, const security::Opened& record,
                                  std::span<const std::byte> content, const net::Address& from) {
  const auto parsed = security::read_handshake(content);
  const auto* const request = std::get_if<HandshakeRequest>(&parsed);
  if (request == nullptr || !fits(request->topic)) {
    ++counters_.handshakes_malformed;
    return;
  }
  Waiting waiting{.from = from, .who = keys, .keys = keys, .under = record.handshake, .record = record.counter};
  put(waiting, *request);
}

void SecureLink::put(Waiting& waiting, const HandshakeRequest& request) noexcept {
  waiting.topic = request.topic;
  waiting.cookie = request.cookie;
  waiting.proofs = request.proofs;
  std::ranges::copy(request.message, waiting.message.begin());
  waiting.message_bytes = request.message.size();
  if (!waiting_.put(waiting)) ++counters_.handshakes_crowded;
}

void SecureLink::answer_waiting(Nanoseconds now) noexcept {
  for (int looks = 0; looks < kLooksAtOnce; ++looks) {
    const auto waiting = waiting_.take();
    if (!waiting) return;
    try {
      if (answer(*waiting, now)) return;
    } catch (const std::exception&) {  // no memory or no randomness: whoever asked asks again
      ++counters_.handshakes_failed;
    }
  }
}

bool SecureLink::answer(const Waiting& waiting, Nanoseconds now) {
  if (waiting.keys != 0) {
    const auto peer = peers_.find(waiting.keys);
    // Otherwise its keys have ended or moved meanwhile: its client asks again.
    return peer != peers_.end() && on_later(peer->second, waiting, now);
  }
  const HandshakeRequest request = waiting.request();
  if (!waiting.proven) {
    refuse_unproven(request, waiting.from);
    return true;
  }
  if (const Peer* const before = asked_before(request)) {
    ++counters_.handshakes_again;
    send_answer(before->answered, waiting.from);
    return false;
  }
  if (has_list() && unconfirmed_of(waiting.who) >= kUnconfirmedOfClient) {
    ++counters_.handshakes_crowded;
    return false;
  }
  on_first(request, waiting.who, waiting.from, now);
  return true;
}

void SecureLink::send_answer(const Answered& answered, const net::Address& to) noexcept {
  link_.send(std::span(answered.bytes).first(answered.length), to);
}

void SecureLink::offer_cookie(const security::HandshakeTopic& topic, const net::Address& from, Nanoseconds now) {
  if (!unreached_.take(from, now)) {
    ++counters_.handshakes_over_rate;
    return;
  }
  ++counters_.cookies_offered;
  const std::size_t bytes = security::write(
      security::CookieOffer{.topic = {.pattern = keys_.pattern(), .handshake = topic.handshake, .client = topic.client},
                            .cookie = cookies_.made_for(named(from), now),
                            .server = keys_.own ? keys_.own->public_key : security::PublicKey{}},
      sealed_);
  link_.send(std::span(sealed_).first(bytes), from);
}

const SecureLink::Peer* SecureLink::asked_before(const HandshakeRequest& request) const noexcept {
  const auto same = std::ranges::find_if(peers_, [&](const auto& entry) {
    const Answered& answered = entry.second.answered;
    return answered.in_clear && answered.topic == request.topic &&
           std::ranges::equal(answered.asked, request.message.first(kAskedBytes));
  });
  return same == peers_.end() ? nullptr : &same->second;
}

std::optional<security::Handshake> SecureLink::read(const HandshakeRequest& request,
                                                    const security::SecretKey* shared) {
  const security::HandshakePrologue prologue = security::prologue_of(request.topic);
  security::Handshake handshake({.pattern = keys_.pattern(),
                                 .role = security::Role::responder,
                                 .prologue = prologue,
                                 .own = keys_.own ? &*keys_.own : nullptr,
                                 .shared = shared});
  if (handshake.read(request.message, {}).result == HandshakeResult::done) return handshake;
  ++counters_.handshakes_not_authentic;
  return std::nullopt;
}

const security::AllowedClient* SecureLink::listed(const security::Handshake& handshake, const net::Address& from) {
  const security::AllowedClient* const client = keys_.clients->find(handshake.peer());
  if (client != nullptr) return client;
  ++counters_.handshakes_not_allowed;
  observer_.on_refused(from, "the list of clients lacks its public key " + security::to_base64(handshake.peer().bytes));
  return nullptr;
}

SecureLink::Decision SecureLink::decide(const security::Handshake& handshake, const net::Address& from) {
  Decision decision;
  if (has_list()) {
    decision.client = listed(handshake, from);
    if (decision.client == nullptr) return {.verdict = Verdict::not_allowed};
  }
  if (!is_full() || evict_from_who_has_most(handshake)) return decision;
  ++counters_.handshakes_full;
  observer_.on_refused(from, "there are keys for as many clients as there may be");
  return {.verdict = Verdict::full};
}

/// Whose key the list lacks is told so, and who has another shared key gets an answer that it cannot read. So does who
/// has the right one: its proof was spoilt on the way, and what it could read would end its handshake. For the same
/// reason nobody of the list is answered.
void SecureLink::refuse_unproven(const HandshakeRequest& request, const net::Address& from) {
  const security::SecretKey nobodys = random_key();
  auto handshake = read(request, judge_.knows_shared(request) ? shared() : &nobodys);
  if (!handshake || (has_list() && listed(*handshake, from) != nullptr)) return;
  Answered refused;
  if (write_answer(*handshake, request, {.verdict = Verdict::not_allowed}, refused)) send_answer(refused, from);
}

void SecureLink::on_first(const HandshakeRequest& request, std::uint64_t charged, const net::Address& from,
                          Nanoseconds now) {
  auto handshake = read(request, shared());
  if (!handshake) return;
  Decision decision = decide(*handshake, from);
  Peer* const peer = decision.verdict == Verdict::let_in ? make_peer(request.topic, charged, now) : nullptr;
  if (peer == nullptr && decision.verdict == Verdict::let_in) {
    ++counters_.handshakes_full;
    decision.verdict = Verdict::full;
  }
  Answered refused;
  Answered& answered = peer == nullptr ? refused : peer->answered;
  const std::uint32_t number = peer == nullptr ? 0 : peer->channel.numbers().own;
  if (!write_answer(*handshake, request, {.verdict = decision.verdict, .server = number}, answered)) {
    if (peer != nullptr) forget(peers_.find(number));
    return;
  }
  if (peer != nullptr) {
    peer->client = decision.client;
    if (keys_.own) peer->key = handshake->peer();
    (void)install(*peer, request.topic, *handshake, now);  // the first number is never in use
    ++counters_.handshakes;
  }
  send_answer(answered, from);
}

SecureLink::Peer* SecureLink::make_peer(const security::HandshakeTopic& topic, std::uint64_t charged, Nanoseconds now) {
  if (unconfirmed() >= kUnconfirmedMost) make_room();
  const std::uint32_t number = new_number();
  try {
    Peer peer{.channel = security::Channel({.own = number, .peer = topic.client}),
              .later = time::TokenBucket(kLaterInterval, kLaterAtOnce, now),
              .moves = time::TokenBucket(kMoveInterval, kMovesAtOnce, now),
              .charged = charged,
              .received = now};
    return &peers_.emplace(number, std::move(peer)).first->second;
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

bool SecureLink::evict_from_who_has_most(const security::Handshake& asking) {
  if (!keys_.own) return false;  // nobody is known from another
  std::map<security::KeyBytes, std::size_t> held;
  // One from elsewhere has no place among these that could become free.
  const auto has_place = [this](const auto& entry) {
    return entry.second.confirmed && !is_from_elsewhere(entry.first);
  };
  for (const auto& entry : peers_) held[entry.second.key.bytes] += has_place(entry) ? 1 : 0;
  const auto most = std::ranges::max_element(held, {}, [](const auto& key_and_count) { return key_and_count.second; });
  if (most == held.end() || most->second <= held[asking.peer().bytes] + 1) return false;
  auto oldest = peers_.end();
  for (auto peer = peers_.begin(); peer != peers_.end(); ++peer) {
    if (!has_place(*peer) || peer->second.key.bytes != most->first) continue;
    if (oldest == peers_.end() || peer->second.received < oldest->second.received) oldest = peer;
  }
  ++counters_.sessions_idle;
  forget(oldest);
  return true;
}

std::size_t SecureLink::unconfirmed_of(std::uint64_t charged) const noexcept {
  return static_cast<std::size_t>(std::ranges::count_if(
      peers_, [&](const auto& entry) { return !entry.second.confirmed && entry.second.charged == charged; }));
}

/// The oldest of whoever has most.
void SecureLink::make_room() {
  std::map<std::uint64_t, std::size_t> held;
  for (const auto& [number, peer] : peers_) held[peer.charged] += peer.confirmed ? 0 : 1;
  auto oldest = peers_.end();
  for (auto peer = peers_.begin(); peer != peers_.end(); ++peer) {
    if (peer->second.confirmed) continue;
    const auto rank = [&](const auto& entry) { return std::pair(held[entry.second.charged], -entry.second.received); };
    if (oldest == peers_.end() || rank(*peer) > rank(*oldest)) oldest = peer;
  }
  if (oldest == peers_.end()) return;
  ++counters_.handshakes_unused;
  forget(oldest);
}

std::uint32_t SecureLink::new_number() {
  auto number = random<std::uint32_t>();
  const auto is_free = [&] {
    return number != 0 && WorkerPlace::owner_of(number, limits_.workers) == limits_.worker &&
           !peers_.contains(number) && (limits_.moved == nullptr || !limits_.moved->worker_of(number));
  };
  while (!is_free()) number = random<std::uint32_t>();
  return number;
}

bool SecureLink::write_answer(security::Handshake& handshake, const HandshakeRequest& request,
                              const security::Admission& admission, Answered& answered) {
  std::array<std::byte, security::kAnswerBytesMost> message{};
  auto ephemeral = random<security::KeyBytes>();
  const auto written = handshake.write(security::to_bytes(admission), message, ephemeral);
  security::wipe(ephemeral.data(), ephemeral.size());
  if (written.result != HandshakeResult::done) {
    ++counters_.handshakes_not_authentic;
    return false;
  }
  answered.topic = request.topic;
  std::ranges::copy(request.message.first(kAskedBytes), answered.asked.begin());
  answered.length = security::write(
      security::HandshakeAnswer{.topic = request.topic, .message = std::span(message).first(written.bytes)},
      answered.bytes);
  return true;
}

bool SecureLink::install(Peer& peer, const security::HandshakeTopic& topic, const security::Handshake& handshake,
                         Nanoseconds now) noexcept {
  handshake.split(*fresh_);
  const bool installed = peer.channel.install(topic.handshake, *fresh_, security::Role::responder, now);
  security::wipe(&*fresh_, sizeof(security::TransportKeys));
  return installed;
}

bool SecureLink::on_later(Peer& peer, const Waiting& waiting, Nanoseconds now) {
  const HandshakeRequest request = waiting.request();
  if (request.topic.client != peer.channel.numbers().peer) {
    ++counters_.handshakes_malformed;
    return false;
  }
  const bool is_copy = !peer.answered.in_clear && peer.answered.topic == request.topic &&
                       std::ranges::equal(peer.answered.asked, request.message.first(kAskedBytes));
  if (is_copy) {
    ++counters_.handshakes_again;
    answer_later(peer, waiting.from, now);
    return false;
  }
  // The client no longer has the keys of an earlier request that comes later.
  if (waiting.under == peer.asked_under && waiting.record < peer.asked_at) {
    ++counters_.handshakes_overtaken;
    return false;
  }
  if (!peer.later.take(now)) {
    ++counters_.handshakes_over_rate;
    return false;
  }
  auto handshake = read(request, shared());
  if (!handshake) return true;
  if (keys_.own && handshake->peer() != peer.key) {
    ++counters_.handshakes_not_allowed;
    return true;
  }
  Answered answered{.in_clear = false};
  const security::Admission admission{.verdict = Verdict::let_in, .server = peer.channel.numbers().own};
  if (!write_answer(*handshake, request, admission, answered)) return true;
  if (!install(peer, request.topic, *handshake, now)) {
    ++counters_.handshakes_malformed;
    return true;
  }
  peer.answered = answered;
  peer.asked_under = waiting.under;
  peer.asked_at = waiting.record;
  ++counters_.handshakes_later;
  answer_later(peer, waiting.from, now);
  return true;
}

void SecureLink::answer_later(Peer& peer, const net::Address& from, Nanoseconds now) {
  const auto bytes = peer.channel.seal(std::span(peer.answered.bytes).first(peer.answered.length), sealed_, now);
  if (bytes) link_.send(std::span(sealed_).first(*bytes), from);
}

}  // namespace forcebound::server
