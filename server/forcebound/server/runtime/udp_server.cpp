#include "forcebound/server/runtime/udp_server.hpp"

#include <algorithm>
#include <array>
#include <new>
#include <random>
#include <utility>

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

/// Random numbers from the system, so that session numbers cannot be guessed.
std::uint64_t random_session_id() {
  static std::random_device device;
  return std::uint64_t{device()} << 32U | device();
}

/// Does what may wait: without memory for it, at the next turn.
template <class Work>
void unless_out_of_memory(const Work& work) {
  try {
    work();
  } catch (const std::bad_alloc&) {
  }
}

std::unique_ptr<SecureLink> secured(std::optional<ServerKeys> keys, const ServerOptions& options,
                                    net::DatagramLink& link, const time::Clock& clock, ServerObserver* observer) {
  if (!keys) return nullptr;
  const SecureLimits limits{.sessions_max = options.sessions_max,
                            .idle_timeout = options.idle_timeout,
                            .worker = options.worker.number,
                            .workers = options.worker.of};
  return std::make_unique<SecureLink>(std::move(*keys), limits, link, clock, security::fill_with_random, observer);
}

ClientRights rights_of(const security::AllowedClient* client) {
  if (client == nullptr) return {};
  return {.name = client->name,
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
                     std::span<const std::unique_ptr<WorkerMail>> mail)
    : link_(std::move(link)),
      secure_(secured(std::move(keys), options, batch_, clock_, observer)),
      compiler_(environments.scenes(),
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
  const auto arrived = batch_.wait_for_some();
  note_busy(clock_.now() - before);
  unless_out_of_memory([this] { compiler_.deliver(); });
  if (!arrived.empty()) take_in(arrived);
  if (!mail_.empty() && !mail_[place_.number]->empty()) take_in_mail();
  answer_all();
  const Nanoseconds now = clock_.now();
  turned_.store(now.count(), std::memory_order_relaxed);
  if (now < timer_) return;
  unless_out_of_memory([&] { server_.on_timer(now); });
  if (secure_) secure_->on_timer(now);
  batch_.flush();
  note_figures();
  timer_ = now + kTimerPeriod;
}

void UdpServer::note_busy(Nanoseconds waited) noexcept {
  waited_ += waited;
  const Nanoseconds now = clock_.now();
  const Nanoseconds elapsed = now - busy_since_;
  if (elapsed < kBusyMean) return;
  server_.note_busy(1 - time::to_seconds(waited_) / time::to_seconds(elapsed), arrived_);
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
  server_.end_sessions_unless([&clients](const std::string& name) {
    return std::ranges::find(clients.all(), name, &security::AllowedClient::name) != clients.all().end();
  });
  batch_.flush();
  secure_->replace_clients(std::move(clients));
}

void UdpServer::stop() {
  server_.stop();
  batch_.flush();
  note_figures();
}

bool UdpServer::end_session(std::uint64_t session) {
  const bool ended = server_.end_session(session);
  batch_.flush();
  return ended;
}

/// These and all that wait behind them.
void UdpServer::take_in(std::span<const net::UdpBatch::Arrived> arrived) {
  for (int i = 0; i < kBatchesPerTurn; ++i, arrived = batch_.receive_all()) {
    const Nanoseconds now = clock_.now();
    arrived_ += arrived.size();
    for (const auto& datagram : arrived) take_in(datagram, now);
    // Another check for datagrams would cost a system call; the next wait checks anyway.
    if (arrived.size() < net::UdpBatch::kDatagramsMax) return;
  }
}

void UdpServer::take_in(const net::UdpBatch::Arrived& datagram, Nanoseconds now) {
  const net::Address& from = datagram.received.from;
  if (!mail_.empty() && was_for_others(datagram, now)) return;
  if (!secure_) {
    server_.take_in(datagram.bytes, from, now);
    if (const auto worker = server_.take_elsewhere()) hand_over(*worker, datagram.bytes, from);
  } else if (const auto opened = secure_->take_in(datagram.bytes, from, now)) {
    server_.take_in(opened->bytes, from, now, rights_of(opened->client));
    const auto worker = server_.take_elsewhere();
    if (!worker) return;
    unless_out_of_memory(
        [&] { hand_over(*worker, opened->bytes, from, secure_->move_out(opened->keys, *worker, now)); });
  }
}

bool UdpServer::was_for_others(const net::UdpBatch::Arrived& datagram, Nanoseconds now) noexcept {
  if (is_wake_up_call(datagram.bytes)) return true;
  auto worker = worker_for(datagram.bytes, place_.of);
  if (secure_ && (!worker || *worker == place_.number)) worker = secure_->moved_to(datagram.bytes, now);
  if (!worker || *worker == place_.number) return false;
  hand_over(*worker, datagram.bytes, datagram.received.from);
  return true;
}

void UdpServer::hand_over(std::size_t worker, std::span<const std::byte> datagram, const net::Address& from,
                          std::optional<SecureLink::Moving> keys) noexcept {
  const WorkerMail::Put put = mail_[worker]->put(datagram, from, std::move(keys));
  ++(put == WorkerMail::Put::no_room ? not_handed_over_ : handed_over_);
  if (put == WorkerMail::Put::taken_first) wake(worker);
}

void UdpServer::wake(std::size_t worker) noexcept {
  net::Address to = link_.local_address();
  // Bound to all of this machine's addresses: one of them.
  if (to.ip == net::Address{}.ip) to.ip.back() = 1;
  constexpr std::array<std::uint8_t, 16> kAllIpv4{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0, 0, 0, 0};
  if (to.ip == kAllIpv4) to.ip = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 127, 0, 0, 1};
  const WakeUpCall call = wake_up_call(worker);
  link_.send(call, to);
}

/// As many datagrams as there were when it began: those who put them down must not hold up this worker's own.
void UdpServer::take_in_mail() {
  WorkerMail& mail = *mail_[place_.number];
  const Nanoseconds now = clock_.now();
  for (std::size_t i = 0; i < WorkerMail::kDatagramsMost && mail.take(handed_); ++i) take_in_handed(now);
  handed_.keys.reset();
  for (const auto& work : mail.take_work()) unless_out_of_memory([&] { work(*this); });
}

void UdpServer::take_in_handed(Nanoseconds now) {
  const auto bytes = std::span<const std::byte>(handed_.bytes).first(handed_.length);
  if (!secure_) {
    server_.take_in_handed(bytes, handed_.from, now);
  } else if (handed_.keys) {
    const auto client = secure_->move_in(*std::exchange(handed_.keys, std::nullopt), handed_.from);
    if (client) server_.take_in_handed(bytes, handed_.from, now, rights_of(*client));
  } else if (const auto opened = secure_->take_in(bytes, handed_.from, now)) {
    server_.take_in_handed(opened->bytes, handed_.from, now, rights_of(opened->client));
  }
}

void UdpServer::note_figures() {
  if (mail_.empty()) return;
  Figures figures{.counters = server_.counters(),
                  .secure = secure_ ? secure_->counters() : SecureCounters{},
                  .busy = server_.busy(),
                  .handed_over = handed_over_,
                  .not_handed_over = not_handed_over_};
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
