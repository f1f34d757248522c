#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "forcebound/server/runtime/steering.hpp"
#include "forcebound/server/runtime/udp_server.hpp"

namespace forcebound::server {

/// A server for each core at one address: workers, each a UdpServer with its own socket, sessions and thread.
///
/// - **The system steers** a session's datagrams to its worker's socket (steering.hpp), whatever address they come
///   from. What comes to another is handed over by a bounded queue. Where the system cannot, there is one worker.
/// - **Limits** on sessions, of all, of an address and of a client, on memory and on Hellos hold for all workers
///   together. A worker that needs the place of another's idle session asks that worker to end it, and answers the next
///   copy of the Hello.
/// - **A shared scene** is in one worker, which its name decides; Hellos that ask for it are handed there, with the
///   keys of their session where there is encryption.
/// - **The first worker** has the thread that calls `turn`; with one worker there is nothing but that.
/// - **A worker that fails** fails all: `turn`, or else `stop`, throws what it threw.
///
/// The observer is called by all workers' threads, under one lock; for motions and forces too if it wants those.
/// All but `alive` is of the thread that calls `turn`.
class ServerWorkers {
 public:
  struct Settings {
    std::size_t workers = 1;
    bool observes_motions = false;  ///< the observer wants motions and forces
    /// Has the system choose the sockets.
    std::function<bool(const net::UdpLink&, std::size_t)> steer = server::steer;
    /// Called first in each of the other workers' threads, as for their scheduling. May be empty; must not throw.
    std::function<void()> begin_thread = {};
  };

  /// @param link of the first worker; the others' are bound beside it
  /// @throws std::invalid_argument as UdpServer's, or unless 1 to kWorkersMost workers are wanted
  /// @throws std::runtime_error if the other sockets cannot be bound
  ServerWorkers(net::UdpLink link, const Settings& settings, ServerOptions options,
                const EnvironmentLibrary& environments, ServerObserver* observer = nullptr,
                std::optional<ServerKeys> keys = std::nullopt);
  ~ServerWorkers();
  ServerWorkers(const ServerWorkers&) = delete;
  ServerWorkers& operator=(const ServerWorkers&) = delete;

  /// Starts the other workers' threads.
  void start();

  /// UdpServer's of the first worker. @throws what another worker threw
  void turn();

  void admit_none(const std::string& why);
  /// @throws std::bad_alloc some workers may still let in those of before
  void replace_clients(const security::AllowedClients& clients);

  /// Of another worker's, it ends after this call. False: there is no session of that number, as far as is known now.
  bool end_session(std::uint64_t session);

  /// Whether all workers have done what `admit_none`, `replace_clients` and `end_session` asked for.
  [[nodiscard]] bool settled() const noexcept;

  /// Ends all sessions and the other workers' threads. @throws what another worker threw
  void stop();

  /// Whether each worker has turned in the last second.
  [[nodiscard]] bool alive(Nanoseconds now) const noexcept;

  /// How many workers there are: as many as wanted, or 1.
  [[nodiscard]] std::size_t size() const noexcept { return workers_.size(); }
  [[nodiscard]] net::Address address() const noexcept { return workers_.front()->server.address(); }
  [[nodiscard]] std::size_t sessions() const noexcept;
  /// Of the busiest worker.
  [[nodiscard]] double busy() const noexcept;
  /// The sum of all workers' counts: the first worker's are of now, the others' of 0.1 s ago at most, or of the end.
  [[nodiscard]] ServerCounters counters() const;
  /// Nothing: sessions are not encrypted.
  [[nodiscard]] std::optional<SecureCounters> secure_counters() const;
  [[nodiscard]] std::uint64_t overflowed() const;
  /// Datagrams that came to a worker that they were not for, and those of them that the other had no room for.
  [[nodiscard]] std::uint64_t handed_over() const;
  [[nodiscard]] std::uint64_t not_handed_over() const;
  /// Those that were lost since the keys they were sealed with had moved too often, or too many had.
  [[nodiscard]] std::uint64_t keys_not_moved() const;

  /// Hold it while reading what the observer has noted; briefly, as workers wait for it.
  [[nodiscard]] std::unique_lock<std::mutex> observer_lock();

 private:
  class LockedObserver;
  struct Worker {
    template <class... Arguments>
    explicit Worker(net::UdpLink link, Arguments&&... arguments)
        : server(std::move(link), std::forward<Arguments>(arguments)...) {}
    UdpServer server;
    std::jthread thread{};
  };
  void work(UdpServer& server, const std::stop_token& wanted) noexcept;
  void post_to_others(const std::function<void(UdpServer&)>& work);
  void end_threads();
  void throw_if_failed();
  [[nodiscard]] std::uint64_t sum_of(std::uint64_t UdpServer::Figures::*figure) const;

  time::SteadyClock clock_;
  std::function<void()> begin_thread_;
  std::unique_ptr<SharedLimits> limits_;  ///< null: one worker
  std::unique_ptr<MovedKeys> moved_;
  std::unique_ptr<LockedObserver> observer_;
  std::vector<std::unique_ptr<WorkerMail>> mail_;
  std::mutex failure_guard_;
  std::exception_ptr failure_;
  std::atomic<bool> failed_{false};
  std::vector<std::unique_ptr<Worker>> workers_;  ///< last: their threads use all of these
};

}  // namespace forcebound::server
