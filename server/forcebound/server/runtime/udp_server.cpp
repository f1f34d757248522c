#include "forcebound/server/runtime/udp_server.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <new>
#include <string_view>
#include <utility>

#include "forcebound/security/locked.hpp"
#include "forcebound/security/random.hpp"
#include "forcebound/server/runtime/steering.hpp"

namespace forcebound::server {
namespace {

// Also the longest delay of the end: a signal between two waits does not end the next one.
constexpr Nanoseconds kTimerPeriod = std::chrono::milliseconds{100};
// Over so long the share of time is taken in which the thread did not wait.
constexpr Nanoseconds kBusyMean = std::chrono::seconds{1};
// A flood must not delay the loop's timer and its end.
constexpr int kBatchesPerTurn = 64;
// Longest time that answers wait to be sent together.
constexpr Nanoseconds kAnswersTogether = std::chrono::microseconds{100};

constexpr std::string_view kTooManyMoved =
    "too many clients are in shared scenes of other threads of this server: end a session in one, or try again later";

/// Random numbers from the system, so that session numbers cannot be guessed.
std::uint64_t random_session_id() {
  std::uint64_t id = 0;
  security::fill_with_random(std::as_writable_bytes(std::span(&id, 1)));
  return id;
}

/// Does what may wait: without memory for it, at the next turn.
template <class Work>
void unless_out_of_memory(const Work& work) {
  try {
    work();
  } catch (const std::bad_alloc&) {
  }
}

std::unique_ptr<SecureLink> secured(std::optional<ServerKeys> keys, const ServerOptions& options, MovedKeys* moved,
                                    net::DatagramLink& link, const time::Clock& clock, ServerObserver* observer) {
  if (!keys) return nullptr;
  const SecureLimits limits{.sessions_max = options.sessions_max,
                            .idle_timeout = options.idle_timeout,
                            .worker = options.worker.number,
                            .workers = options.worker.workers,
                            .moved = moved};
  return std::make_unique<SecureLink>(std::move(*keys), limits, link, clock, security::fill_with_random, observer);
}

/// What tells a client from others, also from one that had its name before.
std::string_view bytes_of(const security::PublicKey& key) noexcept {
  return {reinterpret_cast<const char*>(key.bytes.data()), key.bytes.size()};
}

ClientRights rights_of(const security::AllowedClient* client) {
  if (client == nullptr) return {};
  return {.name = client->name,
          .key = bytes_of(client->key),
          .scenes = client->scenes,
          .motions_per_s_max = client->rate_per_s_max,
          .sessions_max = client->sessions_max};
}

}  // namespace

net::UdpLink listen(const net::Endpoint& endpoint) { return listen_at(net::resolve(endpoint)); }

net::UdpLink listen_at(const net::Address& address) {
  return net::UdpLink::listen(address, net::UdpLink::Stamps::left_out);
}

UdpServer::UdpServer(net::UdpLink link, const ServerOptions& options, const EnvironmentLibrary& environments,
                     ServerObserver* observer, std::optional<ServerKeys> keys,
                     std::span<const std::unique_ptr<WorkerMail>> mail, MovedKeys* moved)
    : link_(std::move(link)),
      secure_(secured(std::move(keys), options, moved, batch_, clock_, observer)),
      maker_(environments,
             [observer](std::string_view scene, std::string_view why) {
               if (observer != nullptr) observer->on_scene_failed(scene, why);
             }),
      server_(options, environments, secure_ ? static_cast<net::DatagramLink&>(*secure_) : batch_, clock_,
              random_session_id, observer),
      timer_(clock_.now() + kTimerPeriod),
      busy_since_(clock_.now()),
      place_(options.worker),
      mail_(mail),
      turned_(clock_.now().count()) {
  link_.wait_at_most(kTimerPeriod);
}

void UdpServer::turn() {
  const Nanoseconds before = clock_.now();
  // Who puts something beside mail that waits wakes nobody.
  const bool mail_waits = !mail_.empty() && !mail_[place_.number]->empty();
  const bool work_waits = mail_waits || (secure_ && secure_->has_waiting());
  const auto arrived = work_waits ? batch_.receive_all() : batch_.wait_for_some();
  update_busy(clock_.now() - before);
  unless_out_of_memory([this] { maker_.deliver(); });
  if (!arrived.empty()) receive(arrived);
  if (!mail_.empty()) receive_mail();
  answer_all();
  if (secure_ && secure_->has_waiting()) answer_handshake();
  const Nanoseconds now = clock_.now();
  turned_.store(now.count(), std::memory_order_relaxed);
  if (now < timer_) return;
  unless_out_of_memory([&] { server_.on_timer(now); });
  if (secure_) secure_->on_timer(now);
  batch_.flush();
  publish_figures();
  timer_ = now + kTimerPeriod;
}

/// One, so that the next motions wait for no more. What it takes is no load of the sessions, which come first.
void UdpServer::answer_handshake() noexcept {
  const Nanoseconds before = clock_.now();
  secure_->answer_waiting(before);
  batch_.flush();
  waited_ += clock_.now() - before;
}

void UdpServer::update_busy(Nanoseconds waited) noexcept {
  waited_ += waited;
  const Nanoseconds now = clock_.now();
  const Nanoseconds elapsed = now - busy_since_;
  if (elapsed < kBusyMean) return;
  server_.store_busy(1 - time::to_seconds(waited_) / time::to_seconds(elapsed), arrived_);
  busy_since_ = now;
  arrived_ = 0;
  waited_ = Nanoseconds{0};
}

void UdpServer::run(const std::stop_token& wanted) {
  while (!wanted.stop_requested()) turn();
  stop();
}

void UdpServer::replace_clients(security::AllowedClients clients) {
  if (!secure_) return;
  // Who is let in no more is told while there is still a key to tell it by.
  server_.end_sessions([&clients](const Session& session) {
    return !session.client.empty() && std::ranges::none_of(clients.all(), [&](const auto& client) {
      return bytes_of(client.key) == session.client;
    });
  });
  batch_.flush();
  secure_->replace_clients(std::move(clients));
}

void UdpServer::stop() {
  server_.stop();
  batch_.flush();
  publish_figures();
}

bool UdpServer::end_session(std::uint64_t session) {
  const bool ended = server_.end_sessions([&](const Session& any) { return any.info.session == session; }) > 0;
  batch_.flush();
  return ended;
}

/// These and all that wait behind them.
void UdpServer::receive(std::span<const net::UdpBatch::Arrived> arrived) {
  for (int i = 0; i < kBatchesPerTurn; ++i, arrived = batch_.receive_all()) {
    const Nanoseconds now = clock_.now();
    arrived_ += arrived.size();
    for (const auto& datagram : arrived) receive(datagram, now);
    // Another check for datagrams would cost a system call; the next wait checks anyway.
    if (arrived.size() < net::UdpBatch::kDatagramsMax) return;
  }
}

void UdpServer::receive(const net::UdpBatch::Arrived& datagram, Nanoseconds now) {
  if (!mail_.empty() && was_for_others(datagram)) return;
  receive_own(datagram.bytes, datagram.received.from, now);
}

/// What came to this worker's socket, or was for it and came to another's.
void UdpServer::receive_own(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now) {
  using Stage = WorkerMail::Stage;
  if (!secure_) {
    const auto home = server_.receive(datagram, {.address = from}, now);
    if (home) hand_over(*home, {.bytes = datagram, .from = from, .stage = Stage::hello_judged});
    return;
  }
  const auto opened = secure_->accept(datagram, from, now);
  if (!opened) return;
  if (const auto owner = owner_of(*opened)) {
    (void)hand_over_with_keys(*owner, *opened, {.bytes = opened->bytes, .from = from, .stage = Stage::opened}, now);
    return;
  }
  const auto home = server_.receive(opened->bytes, {.address = from, .rights = rights_of(opened->client)}, now);
  if (!home) return;
  const auto moved =
      hand_over_with_keys(*home, *opened, {.bytes = opened->bytes, .from = from, .stage = Stage::hello_judged}, now);
  if (moved == SecureLink::MovedOut::too_many) server_.refuse_hello(opened->bytes, from, kTooManyMoved);
}

bool UdpServer::was_for_others(const net::UdpBatch::Arrived& datagram) noexcept {
  if (is_wake_up_call(datagram.bytes)) {
    --arrived_;  // of no client
    return true;
  }
  auto worker = worker_for(datagram.bytes, place_.workers);
  if (secure_ && (!worker || *worker == place_.number)) worker = secure_->moved_to(datagram.bytes);
  if (!worker || *worker == place_.number) return false;
  --arrived_;  // of the other's clients, and counted there
  hand_over(*worker, {.bytes = datagram.bytes, .from = datagram.received.from});
  return true;
}

/// A client makes new keys after a silence, at the worker that its address hashes to: its session may be at another.
std::optional<std::size_t> UdpServer::owner_of(const SecureLink::Content& content) const noexcept {
  if (mail_.empty()) return std::nullopt;
  const auto worker = worker_for(content.bytes, place_.workers);
  if (!worker || *worker == place_.number) return std::nullopt;
  const auto heading = wire::heading_of(content.bytes);
  const auto* const sound = std::get_if<wire::Heading>(&heading);
  const std::string_view client = content.client == nullptr ? std::string_view{} : bytes_of(content.client->key);
  if (sound == nullptr || !place_.limits->has(sound->session, client)) return std::nullopt;
  return WorkerPlace::owner_of(sound->session, place_.workers);
}

bool UdpServer::hand_over(std::size_t worker, const WorkerMail::Datagram& datagram, SecureLink::Moving* keys) noexcept {
  WorkerMail::Datagram handed = datagram;
  handed.worker = place_.number;
  const WorkerMail::Put put = mail_[worker]->put(handed, keys);
  const bool taken = put != WorkerMail::Put::no_room;
  ++(taken ? handed_over_ : not_handed_over_);
  if (put == WorkerMail::Put::was_empty) wake(worker);
  return taken;
}

SecureLink::MovedOut UdpServer::hand_over_with_keys(std::size_t worker, const SecureLink::Content& content,
                                                    const WorkerMail::Datagram& datagram, Nanoseconds now) noexcept {
  using MovedOut = SecureLink::MovedOut;
  const auto give = [&](SecureLink::Moving& keys) { return hand_over(worker, datagram, &keys); };
  // By reference: a copy of it would need memory, which there may be none of.
  const MovedOut moved = secure_->move_out(content.keys, worker, now, std::ref(give));
  if (moved == MovedOut::too_often || moved == MovedOut::too_many) ++keys_not_moved_;
  return moved;
}

void UdpServer::wake(std::size_t worker) noexcept {
  net::Address to = link_.local_address();
  const WakeUpCall call = wake_up_call(worker);
  constexpr net::Address kLoopback6{.ip = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}};
  constexpr net::Address kLoopback4{.ip = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 127, 0, 0, 1}};
  constexpr net::Address kAllIpv4{.ip = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0, 0, 0, 0}};
  // Bound to all of this machine's addresses: one of them. The machine may have no IPv6.
  const bool of_both = to.ip == net::Address{}.ip;
  if (of_both) to.ip = kLoopback6.ip;
  if (to.ip == kAllIpv4.ip) to.ip = kLoopback4.ip;
  if (link_.send(call, to) || !of_both) return;
  to.ip = kLoopback4.ip;
  link_.send(call, to);
}

/// As many datagrams as there is room for at most: those who put down more meanwhile must not hold up this worker's
/// own.
void UdpServer::receive_mail() {
  WorkerMail& mail = *mail_[place_.number];
  if (!mail.empty()) {
    const Nanoseconds now = clock_.now();
    for (std::size_t i = 0; i < WorkerMail::kDatagramsMost && mail.take(handed_); ++i) {
      ++arrived_;
      receive_handed(now);
    }
  }
  if (!mail.work_done()) mail.do_work(*this);
}

void UdpServer::receive_handed(Nanoseconds now) {
  using Stage = WorkerMail::Stage;
  const auto bytes = std::span(handed_.bytes).first(handed_.length);
  if (handed_.stage == Stage::as_it_came) return receive_own(bytes, handed_.from, now);
  const bool judged = handed_.stage == Stage::hello_judged;
  if (handed_.keys) {
    const auto client = secure_->move_in(*std::exchange(handed_.keys, std::nullopt), handed_.from, now);
    if (client) server_.receive(bytes, {.address = handed_.from, .rights = rights_of(*client), .judged = judged}, now);
    security::wipe(bytes.data(), bytes.size());
    return;
  }
  server_.receive(bytes, {.address = handed_.from, .judged = true}, now);
}

void UdpServer::publish_figures() {
  Figures figures{.counters = server_.counters(),
                  .secure = secure_ ? secure_->counters() : SecureCounters{},
                  .sessions = server_.sessions(),
                  .busy = server_.busy(),
                  .overflowed = link_.counters().overflowed,
                  .handed_over = handed_over_,
                  .not_handed_over = not_handed_over_,
                  .keys_not_moved = keys_not_moved_};
  const std::lock_guard lock(figures_guard_);
  figures_ = figures;
}

UdpServer::Figures UdpServer::figures() const {
  const std::lock_guard lock(figures_guard_);
  return figures_;
}

/// The newest motion of each client.
void UdpServer::answer_all() {
  // A finished answer must not wait for another client's slow scene.
  Nanoseconds flushed = clock_.now();
  while (server_.answer_next()) {
    if (clock_.now() - flushed < kAnswersTogether) continue;
    batch_.flush();
    flushed = clock_.now();
  }
  batch_.flush();
}

}  // namespace forcebound::server
