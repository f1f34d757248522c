#include "forcebound/client/security/handshaker.hpp"

#include <algorithm>
#include <boost/lockfree/spsc_queue.hpp>
#include <stdexcept>
#include <utility>

namespace forcebound::client {
namespace {

constexpr Nanoseconds kPauseLeast = std::chrono::milliseconds{100};
constexpr Nanoseconds kPauseMost = std::chrono::seconds{2};
constexpr Nanoseconds kRequestKept = std::chrono::seconds{30};
// A forged offer must not make the client send at any rate.
constexpr Nanoseconds kTryPause = std::chrono::milliseconds{20};
// Where any key is believed: the one that was tried last is given the time for an answer.
constexpr Nanoseconds kKeyPause = std::chrono::seconds{1};
// A server that knows the shared key has answered by then, over most networks.
constexpr Nanoseconds kAnswerExpected = std::chrono::seconds{3};
constexpr std::size_t kReceivedMost = 64;
constexpr std::size_t kOutgoingMost = 4;

}  // namespace

struct Handshaker::Queues {
  boost::lockfree::spsc_queue<Incoming> incoming{kReceivedMost};
  boost::lockfree::spsc_queue<Outgoing> outgoing{kOutgoingMost};
};

Handshaker::Handshaker(Identity identity, FillRandom random)
    : identity_(std::move(identity)), random_(std::move(random)), queues_(std::make_unique<Queues>()) {
  if (identity_.pattern == security::Pattern::nn_psk0) {
    if (!identity_.shared) throw std::invalid_argument("a handshake of the pattern NNpsk0 needs a shared key");
    return;
  }
  if (!identity_.own) throw std::invalid_argument("a handshake of the pattern IKpsk2 needs a key pair");
  if (!identity_.server_key && !identity_.known) {
    throw std::invalid_argument("a handshake of the pattern IKpsk2 needs the server's public key, or known servers");
  }
}

Handshaker::~Handshaker() = default;

void Handshaker::want(Wanted what, std::uint8_t handshake) noexcept {
  newest_handshake_.store(handshake, std::memory_order_relaxed);
  wanted_.store(what, std::memory_order_release);
}

bool Handshaker::receive(std::span<const std::byte> datagram) noexcept {
  Incoming incoming;
  if (datagram.size() > incoming.bytes.size()) return false;
  const auto read = security::read_handshake(datagram);
  const security::HandshakeTopic* topic = nullptr;
  if (const auto* offer = std::get_if<security::CookieOffer>(&read)) topic = &offer->topic;
  if (const auto* answer = std::get_if<security::HandshakeAnswer>(&read)) topic = &answer->topic;
  const std::uint32_t awaited = awaited_.load(std::memory_order_relaxed);
  if (topic == nullptr || awaited == 0 || topic->client != awaited) return false;
  std::ranges::copy(datagram, incoming.bytes.begin());
  incoming.length = datagram.size();
  return queues_->incoming.push(incoming);
}

bool Handshaker::take(Outgoing& outgoing) noexcept { return queues_->outgoing.pop(outgoing); }

std::optional<Handshaker::Made> Handshaker::made() const noexcept {
  if (!made_ready_.load(std::memory_order_acquire)) return std::nullopt;
  return made_;
}

void Handshaker::keys_taken() noexcept {
  security::wipe(&*keys_, sizeof *keys_);
  made_ready_.store(false, std::memory_order_release);
}

void Handshaker::work(Nanoseconds now) {
  // What is wanted next is said together with the taking of the keys.
  if (made_ready_.load(std::memory_order_acquire)) return;
  const Wanted wanted = wanted_.load(std::memory_order_acquire);
  if (wanted != task_) begin(wanted, now);
  Incoming incoming;
  while (queues_->incoming.pop(incoming)) {
    if (task_ != Wanted::nothing) on_received(std::span(incoming.bytes).first(incoming.length), now);
  }
  if (task_ == Wanted::nothing) return;
  if (now - begun_ >= kRequestKept) begin(task_, now);
  if (now >= next_try_) try_an_offer(now);
  if (now >= next_sent_) say(now);
}

void Handshaker::begin(Wanted what, Nanoseconds now) {
  end();
  task_ = what;
  if (what == Wanted::nothing) return;
  begun_ = now;
  next_sent_ = now;
  pause_ = kPauseLeast;
  topic_.pattern = identity_.pattern;
  if (what == Wanted::next_key) {
    topic_.handshake = static_cast<std::uint8_t>(newest_handshake_.load(std::memory_order_relaxed) + 1);
    topic_.client = session_client_;
    write_message();
  } else {
    topic_.handshake = 1;
    do {
      random_(std::as_writable_bytes(std::span(&topic_.client, 1)));
    } while (topic_.client == 0);
  }
  awaited_.store(topic_.client, std::memory_order_relaxed);
}

void Handshaker::end() noexcept {
  task_ = Wanted::nothing;
  awaited_.store(0, std::memory_order_relaxed);
  handshake_.reset();
  message_bytes_ = 0;
  cookie_ = {};
  offers_.clear();
  next_try_ = Nanoseconds::min();
  next_key_ = Nanoseconds::min();
}

/// Noise's first message to `expected_`.
void Handshaker::write_message() {
  const security::HandshakePrologue prologue = security::prologue_of(topic_);
  handshake_.emplace(security::HandshakeSetup{.pattern = identity_.pattern,
                                              .role = security::Role::initiator,
                                              .prologue = prologue,
                                              .own = identity_.own ? &*identity_.own : nullptr,
                                              .peer = expected_ ? &*expected_ : nullptr,
                                              .shared = identity_.shared ? &*identity_.shared : nullptr});
  security::KeyBytes random;
  random_(random);
  const auto written = handshake_->write({}, message_, random);
  security::wipe(random.data(), random.size());
  message_bytes_ = written.bytes;
  proof_keys_ = {};
  if (identity_.own && expected_) proof_keys_.own.emplace(*identity_.own, *expected_);
  if (identity_.shared) proof_keys_.shared.emplace(*identity_.shared);
  if (written.result == security::HandshakeResult::done) return;
  handshake_.reset();
  set_problem("the server's public key cannot be anybody's: nothing is sent to it");
}

void Handshaker::say(Nanoseconds now) {
  Outgoing outgoing;
  const std::array<std::byte, security::kSealedRequestBytesMost> none{};
  const std::size_t bytes = security::Handshake::overhead(topic_.pattern, 0);
  security::HandshakeRequest request{
      .topic = topic_,
      .cookie = cookie_,
      .message = std::span<const std::byte>(message_bytes_ > 0 ? message_ : none).first(bytes)};
  outgoing.sealed = task_ == Wanted::next_key;
  if (!outgoing.sealed && message_bytes_ > 0) request.proofs = proof_keys_.of(security::digest_of(request));
  const std::size_t length = security::write(request, outgoing.bytes);
  outgoing.length = outgoing.sealed ? length : security::kRequestBytes;
  if (!queues_->outgoing.push(outgoing)) return;  // the tick rests: later
  next_sent_ = now + pause_;
  pause_ = std::min(2 * pause_, kPauseMost);
  set_problem_if_silent(now);
}

void Handshaker::on_received(std::span<const std::byte> datagram, Nanoseconds now) {
  const auto read = security::read_handshake(datagram);
  if (const auto* offer = std::get_if<security::CookieOffer>(&read)) on_offer(*offer);
  if (const auto* answer = std::get_if<security::HandshakeAnswer>(&read)) on_answer(*answer, now);
}

void Handshaker::on_offer(const security::CookieOffer& offer) {
  if (task_ != Wanted::session || offer.topic.client != topic_.client) return;
  if (offer.topic.pattern != topic_.pattern) {
    set_problem(offer.topic.pattern == security::Pattern::nn_psk0
                    ? identity_.server + " has no key pair; accepted is its shared key alone: --psk"
                    : identity_.server +
                          " has a key pair; accepted is its public key: --server-key or --known-servers");
    return;
  }
  Offer kept{.cookie = offer.cookie};
  if (topic_.pattern == security::Pattern::ik_psk2) {
    kept.server = key_to_expect(offer.server);
    if (!kept.server) return;
  }
  const bool is_tried = kept.cookie == cookie_ && kept.server == expected_;
  if (is_tried || std::ranges::find(offers_, kept) != offers_.end()) return;
  if (offers_.size() < kOffersMost) {
    offers_.push_back(kept);
  } else {
    offers_[below(kOffersMost)] = kept;  // which by chance: a flood takes no more than its share
  }
}

/// One of those that came since the last, by chance: in any order that is known, somebody could be first for ever.
void Handshaker::try_an_offer(Nanoseconds now) {
  const auto first = std::partition(offers_.begin(), offers_.end(),
                                    [&](const Offer& offer) { return offer.server != expected_ && now < next_key_; });
  if (first == offers_.end()) return;
  const auto chosen = first + static_cast<std::ptrdiff_t>(below(static_cast<std::size_t>(offers_.end() - first)));
  cookie_ = chosen->cookie;
  if (chosen->server != expected_) {
    expected_ = chosen->server;
    next_key_ = now + kKeyPause;
    message_bytes_ = 0;
  }
  offers_.clear();  // the server offers its own again
  if (message_bytes_ == 0) write_message();
  next_sent_ = now;
  next_try_ = now + kTryPause;
  pause_ = kPauseLeast;
}

/// A whole number by chance, less than `end`, to a precision of 2^-26 for those of ours.
std::size_t Handshaker::below(std::size_t end) {
  std::uint32_t number = 0;
  random_(std::as_writable_bytes(std::span(&number, 1)));
  return number % end;
}

/// Nothing: a key that is not believed. The key offered is not yet shown to be the server's; what is known is.
std::optional<security::PublicKey> Handshaker::key_to_expect(const security::PublicKey& offered) {
  if (identity_.server_key) {
    if (*identity_.server_key != offered) {
      set_problem(identity_.server + " says that it has the key " + security::to_base64(offered.bytes) +
                  ", not the one of --server-key: it was given another key, or somebody else answers");
    }
    return identity_.server_key;
  }
  const auto known = identity_.known->find(identity_.server);
  if (!known && identity_.new_servers == security::NewServers::trusted) return offered;
  try {
    identity_.known->expect(identity_.server, offered, security::NewServers::refused);
  } catch (const std::exception& error) {
    set_problem(error.what());
  }
  return known;
}

void Handshaker::on_answer(const security::HandshakeAnswer& answer, Nanoseconds now) {
  if (answer.topic != topic_ || !handshake_) return;
  std::array<std::byte, security::kAdmissionBytes> payload{};
  const auto read = handshake_->read(answer.message, payload);
  if (read.result == security::HandshakeResult::not_authentic) {
    set_problem(identity_.server + " answered, but not with the keys that are expected: it has another --psk, or " +
                "somebody else answers");
  }
  if (read.result != security::HandshakeResult::done) return;
  const auto admission = security::admission_from(std::span(payload).first(read.bytes));
  if (!admission) return;
  if (admission->verdict == security::Verdict::let_in) {
    on_admitted(*admission);
    return;
  }
  if (admission->verdict == security::Verdict::full) {
    set_problem(identity_.server + " is full: it takes no more clients now");
  } else {
    set_problem(identity_.server + " does not let this client in" +
                (identity_.own
                     ? ": its list of clients lacks the key " + security::to_base64(identity_.own->public_key.bytes)
                     : std::string()));
  }
  // Asked again later: it may be let in then.
  handshake_.reset();
  message_bytes_ = 0;
  cookie_ = {};
  offers_.clear();
  next_sent_ = next_try_ = now + kPauseMost;
}

void Handshaker::on_admitted(const security::Admission& admission) {
  const bool new_session = task_ == Wanted::session;
  if (new_session) {
    session_client_ = topic_.client;
    session_server_ = admission.server;
  } else if (admission.server != session_server_) {
    return;
  }
  std::string problem;
  if (expected_ && identity_.known && !identity_.server_key) {
    // It has shown that the key is its own.
    try {
      identity_.known->expect(identity_.server, *expected_, identity_.new_servers);
    } catch (const std::exception& error) {
      problem = error.what();
    }
  }
  handshake_->split(*keys_);
  made_ = {.numbers = {.own = session_client_, .peer = session_server_},
           .handshake = topic_.handshake,
           .of_new_session = new_session,
           .keys = &*keys_};
  {
    const std::scoped_lock lock(texts_);
    problem_ = std::move(problem);
    if (new_session) {
      news_ = expected_ ? "encrypted (IKpsk2), server's key " + security::to_base64(expected_->bytes)
                        : std::string("encrypted (NNpsk0), by the shared key");
    }
  }
  end();
  made_ready_.store(true, std::memory_order_release);
}

/// What it may mean that a request was not answered.
void Handshaker::set_problem_if_silent(Nanoseconds now) {
  if (task_ != Wanted::session || message_bytes_ == 0 || now - begun_ < kAnswerExpected) return;
  const std::scoped_lock lock(texts_);
  if (!problem_.empty()) return;
  const std::string key = identity_.pattern == security::Pattern::nn_psk0 ? "another --psk" : "another key";
  const bool knew_keys = session_server_ != 0;
  problem_ =
      identity_.server + " does not answer the handshake: " +
      (knew_keys ? "datagrams are lost, or it has " + key + " now" : "it has " + key + ", or datagrams are lost");
}

void Handshaker::set_problem(std::string text) {
  const std::scoped_lock lock(texts_);
  problem_ = std::move(text);
}

std::string Handshaker::problem() const {
  const std::scoped_lock lock(texts_);
  return problem_;
}

std::string Handshaker::take_news() {
  const std::scoped_lock lock(texts_);
  return std::exchange(news_, {});
}

}  // namespace forcebound::client
