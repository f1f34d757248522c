#include "forcebound/server/runtime/udp_server.hpp"

#include <algorithm>
#include <new>
#include <random>
#include <utility>

#include "forcebound/security/random.hpp"

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
  const SecureLimits limits{.sessions_max = options.sessions_max, .idle_timeout = options.idle_timeout};
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
                     ServerObserver* observer, std::optional<ServerKeys> keys)
    : link_(std::move(link)),
      secure_(secured(std::move(keys), options, batch_, clock_, observer)),
      compiler_(environments.scenes(),
                [observer](std::string_view scene, std::string_view why) {
                  if (observer != nullptr) observer->on_scene_failed(scene, why);
                }),
      server_(options, environments, secure_ ? static_cast<net::DatagramLink&>(*secure_) : batch_, clock_,
              random_session_id, observer),
      timer_(clock_.now() + kTimerPeriod),
      busy_since_(clock_.now()) {
  link_.wait_at_most(kTimerPeriod);
}

void UdpServer::turn() {
  const Nanoseconds before = clock_.now();
  const auto arrived = batch_.wait_for_some();
  note_busy(clock_.now() - before);
  unless_out_of_memory([this] { compiler_.deliver(); });
  if (!arrived.empty()) {
    take_in(arrived);
    answer_all();
  }
  const Nanoseconds now = clock_.now();
  if (now < timer_) return;
  unless_out_of_memory([&] { server_.on_timer(now); });
  if (secure_) secure_->on_timer(now);
  batch_.flush();
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
  if (!secure_) {
    server_.take_in(datagram.bytes, from, now);
  } else if (const auto opened = secure_->take_in(datagram.bytes, from, now)) {
    server_.take_in(opened->bytes, from, now, rights_of(opened->client));
  }
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
