#include "forcebound/server/runtime/server_workers.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "forcebound/security/random.hpp"

namespace forcebound::server {
namespace {

constexpr Nanoseconds kAliveWithin = std::chrono::seconds{1};

std::uint64_t random_hash_key() {
  std::uint64_t key = 0;
  security::fill_with_random(std::as_writable_bytes(std::span(&key, 1)));
  return key;
}

}  // namespace

/// Lets one worker's thread at a time through.
class ServerWorkers::LockedObserver final : public ServerObserver {
 public:
  LockedObserver(ServerObserver& next, bool motions_too) : next_(next), motions_too_(motions_too) {}

  void on_opened(const SessionInfo& info) override {
    const std::lock_guard lock(guard);
    next_.on_opened(info);
  }
  void on_closed(const SessionInfo& info, CloseReason reason, const wire::Bye& final_counts) override {
    const std::lock_guard lock(guard);
    next_.on_closed(info, reason, final_counts);
  }
  void on_refused(const net::Address& address, std::string_view text) override {
    const std::lock_guard lock(guard);
    next_.on_refused(address, text);
  }
  void on_scene_failed(std::string_view scene, std::string_view why) override {
    const std::lock_guard lock(guard);
    next_.on_scene_failed(scene, why);
  }
  void on_unsound_response(const SessionInfo& info) noexcept override {
    const std::lock_guard lock(guard);
    next_.on_unsound_response(info);
  }
  void on_quarantined(const SessionInfo& info, std::string_view object) noexcept override {
    const std::lock_guard lock(guard);
    next_.on_quarantined(info, object);
  }
  void on_motion(const wire::MotionSample& motion) noexcept override {
    if (!motions_too_) return;
    const std::lock_guard lock(guard);
    next_.on_motion(motion);
  }
  void on_force(const wire::EnvironmentForce& force) noexcept override {
    if (!motions_too_) return;
    const std::lock_guard lock(guard);
    next_.on_force(force);
  }

  std::mutex guard;

 private:
  ServerObserver& next_;
  bool motions_too_;
};

ServerWorkers::ServerWorkers(net::UdpLink link, const Settings& settings, ServerOptions options,
                             const EnvironmentLibrary& environments, ServerObserver* observer,
                             std::optional<ServerKeys> keys)
    : begin_thread_(settings.begin_thread) {
  if (settings.workers < 1 || settings.workers > WorkerPlace::kWorkersMost) {
    throw std::invalid_argument("workers must be 1 to " + std::to_string(WorkerPlace::kWorkersMost) + ", got " +
                                std::to_string(settings.workers));
  }
  std::vector<net::UdpLink> links;
  links.push_back(std::move(link));
  while (links.size() < settings.workers) {
    links.push_back(net::UdpLink::beside(links.front(), net::UdpLink::Stamps::left_out));
  }
  // Otherwise even wake-up calls would go to a worker that they are not for.
  if (links.size() > 1 && !settings.steer(links.front(), links.size())) links.erase(links.begin() + 1, links.end());
  if (links.size() == 1) {
    workers_.push_back(
        std::make_unique<Worker>(std::move(links.front()), options, environments, observer, std::move(keys)));
    return;
  }
  moved_ = std::make_unique<MovedKeys>(SecureLimits::confirmed_most_of(options.sessions_max), links.size());
  limits_ = std::make_unique<SharedLimits>(options.hellos_per_s_max, clock_.now(), random_hash_key());
  if (observer != nullptr) observer_ = std::make_unique<LockedObserver>(*observer, settings.observes_motions);
  for (std::size_t i = 0; i < links.size(); ++i) mail_.push_back(std::make_unique<WorkerMail>());
  for (std::size_t i = 0; i < links.size(); ++i) {
    options.worker = {.number = i, .workers = links.size(), .limits = limits_.get()};
    workers_.push_back(std::make_unique<Worker>(std::move(links[i]), options, environments.copy(), observer_.get(),
                                                keys ? std::optional(keys->copy()) : std::nullopt, mail_,
                                                moved_.get()));
  }
}

ServerWorkers::~ServerWorkers() { end_threads(); }

void ServerWorkers::start() {
  for (std::size_t i = 1; i < workers_.size(); ++i) {
    Worker& worker = *workers_[i];
    worker.thread = std::jthread([this, &worker](const std::stop_token& wanted) { work(worker.server, wanted); });
  }
}

void ServerWorkers::work(UdpServer& server, const std::stop_token& wanted) noexcept {
  try {
    if (begin_thread_) begin_thread_();
    server.run(wanted);
  } catch (...) {
    const std::lock_guard lock(failure_guard_);
    failure_ = std::current_exception();
    failed_ = true;
  }
}

void ServerWorkers::turn() {
  workers_.front()->server.turn();
  throw_if_failed();
}

void ServerWorkers::throw_if_failed() {
  if (!failed_) return;
  const std::lock_guard lock(failure_guard_);
  std::rethrow_exception(failure_);
}

void ServerWorkers::post_to_others(const std::function<void(UdpServer&)>& work) {
  for (std::size_t i = 1; i < workers_.size(); ++i) {
    mail_[i]->post_work(work);
    workers_.front()->server.wake(i);
  }
}

void ServerWorkers::admit_none(const std::string& why) {
  post_to_others([why](UdpServer& server) { server.admit_none(why); });
  workers_.front()->server.admit_none(why);
}

void ServerWorkers::replace_clients(const security::AllowedClients& clients) {
  workers_.front()->server.replace_clients(clients);
  post_to_others([clients](UdpServer& server) { server.replace_clients(clients); });
}

bool ServerWorkers::end_session(std::uint64_t session) {
  const std::size_t owner = WorkerPlace::owner_of(session, workers_.size());
  if (owner == 0) return workers_.front()->server.end_session(session);
  if (!limits_->has(session)) return false;
  mail_[owner]->post_work([session](UdpServer& server) { (void)server.end_session(session); });
  workers_.front()->server.wake(owner);
  return true;
}

bool ServerWorkers::settled() const noexcept {
  return std::ranges::all_of(mail_, [](const auto& mail) { return mail->work_done(); });
}

void ServerWorkers::stop() {
  workers_.front()->server.stop();
  end_threads();
  throw_if_failed();
}

void ServerWorkers::end_threads() {
  for (std::size_t i = 1; i < workers_.size(); ++i) {
    workers_[i]->thread.request_stop();
    workers_.front()->server.wake(i);
  }
  for (const auto& worker : workers_) {
    if (worker->thread.joinable()) worker->thread.join();
  }
}

bool ServerWorkers::alive(Nanoseconds now) const noexcept {
  return std::ranges::all_of(workers_,
                             [&](const auto& worker) { return now - worker->server.turned() < kAliveWithin; });
}

std::size_t ServerWorkers::sessions() const noexcept {
  return limits_ ? limits_->sessions() : workers_.front()->server.server().sessions();
}

double ServerWorkers::busy() const noexcept {
  double most = workers_.front()->server.server().busy();
  for (const auto& worker : workers_) most = std::max(most, worker->server.figures().busy);
  return most;
}

ServerCounters ServerWorkers::counters() const {
  ServerCounters all = workers_.front()->server.server().counters();
  for (std::size_t i = 1; i < workers_.size(); ++i) all.add(workers_[i]->server.figures().counters);
  return all;
}

std::optional<SecureCounters> ServerWorkers::secure_counters() const {
  const SecureLink* const encryption = workers_.front()->server.encryption();
  if (encryption == nullptr) return std::nullopt;
  SecureCounters all = encryption->counters();
  for (std::size_t i = 1; i < workers_.size(); ++i) all.add(workers_[i]->server.figures().secure);
  return all;
}

std::uint64_t ServerWorkers::overflowed() const {
  return std::accumulate(
      workers_.begin() + 1, workers_.end(), workers_.front()->server.overflowed(),
      [](std::uint64_t sum, const auto& worker) { return sum + worker->server.figures().overflowed; });
}

std::uint64_t ServerWorkers::sum_of(std::uint64_t UdpServer::Figures::*figure) const {
  return std::accumulate(
      workers_.begin(), workers_.end(), std::uint64_t{0},
      [figure](std::uint64_t sum, const auto& worker) { return sum + worker->server.figures().*figure; });
}

std::uint64_t ServerWorkers::handed_over() const { return sum_of(&UdpServer::Figures::handed_over); }

std::uint64_t ServerWorkers::not_handed_over() const { return sum_of(&UdpServer::Figures::not_handed_over); }

std::uint64_t ServerWorkers::keys_not_moved() const { return sum_of(&UdpServer::Figures::keys_not_moved); }

std::unique_lock<std::mutex> ServerWorkers::observer_lock() {
  return observer_ ? std::unique_lock(observer_->guard) : std::unique_lock<std::mutex>();
}

}  // namespace forcebound::server
