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

#include "forcebound/server/runtime/udp_server.hpp"

namespace forcebound::server {

/// A server for each core at one address: workers, each a UdpServer with its own socket, sessions and thread.
///
/// - **The system steers** a session's datagrams to its worker's socket (steering.hpp), whatever address they come
/// from.
///   What comes to another is handed over by a bounded queue.
/// - **Limits** on sessions, of all, of an address and of a client, on memory and on Hellos hold for all workers
/// together.
///   A worker that has no place left ends none of another's sessions for one, though: who asks is refused.
/// - **A shared scene** is in one worker, which its name decides; Hellos that ask for it are handed there, with the
/// keys
///   of their session where there is encryption.
/// - **The first worker** has the thread that calls `turn`; with one worker there is nothing but that.
/// - **A worker that fails** fails all: `turn` throws what it threw.
///
/// The observer is called by all workers' threads, under one lock; for motions and forces too if it wants those.
/// All but `alive` is of the thread that calls `turn`.
class ServerWorkers {
 public:
  struct Settings {
    std::size_t workers = 1;
    bool observes_motions = false;  ///< the observer wants motions and forces
  };

  /// @param link of the first worker; the others' are bound beside it
  /// @throws std::invalid_argument as UdpServer's, or unless there are 1 to WorkerPlace::kMost workers
  /// @throws std::runtime_error if the other sockets cannot be bound
  ServerWorkers(net::UdpLink link, const Settings& settings, ServerOptions options,
                const EnvironmentLibrary& environments, ServerObserver* observer = nullptr,
                std::optional<ServerKeys> keys = std::nullopt);
  ~ServerWorkers();
  ServerWorkers(const ServerWorkers&) = delete;
  ServerWorkers& operator=(const ServerWorkers&) = delete;

  /// Starts the other workers' threads, which inherit this one's scheduling.
  void start();

  /// UdpServer's of the first worker. @throws what another worker threw
  void turn();

  void admit_none(const std::string& why);
  void replace_clients(const security::AllowedClients& clients);

  /// Of another worker's, it ends after this call. False: there is no session of that number, as far as is known now.
  bool end_session(std::uint64_t session);

  /// Ends all sessions and the other workers' threads.
  void stop();

  /// Whether each worker has turned in the last second.
  [[nodiscard]] bool alive(Nanoseconds now) const noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return workers_.size(); }
  [[nodiscard]] net::Address address() const noexcept { return workers_.front()->server.address(); }
  [[nodiscard]] std::size_t sessions() const noexcept;
  /// Of the busiest worker.
  [[nodiscard]] double busy() const noexcept;
  /// Of all; those of the others as they were 0.1 s ago at most, or at the end.
  [[nodiscard]] ServerCounters counters() const;
  /// Nothing: sessions are not encrypted.
  [[nodiscard]] std::optional<SecureCounters> secure_counters() const;
  [[nodiscard]] std::uint64_t overflowed() const noexcept;
  /// Datagrams that came to a worker that they were not for, and those that were lost as the other had no room for
  /// them.
  [[nodiscard]] std::uint64_t handed_over() const;
  [[nodiscard]] std::uint64_t not_handed_over() const;

  /// Held by whoever reads what the observer has noted.
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
  void ask_others(const std::function<void(UdpServer&)>& work);

  time::SteadyClock clock_;
  std::unique_ptr<SharedLimits> limits_;  ///< null: one worker
  std::unique_ptr<LockedObserver> observer_;
  std::vector<std::unique_ptr<WorkerMail>> mail_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::mutex failure_guard_;
  std::exception_ptr failure_;
  std::atomic<bool> failed_{false};
};

}  // namespace forcebound::server
