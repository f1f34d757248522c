#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/udp_batch.hpp"
#include "forcebound/net/udp_link.hpp"
#include "forcebound/server/runtime/environment_maker.hpp"
#include "forcebound/server/runtime/worker_mail.hpp"
#include "forcebound/server/security/secure_link.hpp"
#include "forcebound/server/session/server.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::server {

/// A socket for a server; port 0 takes any free one.
/// @throws std::runtime_error with the reason why the address is not available
net::UdpLink listen(const net::Endpoint& endpoint);
net::UdpLink listen_at(const net::Address& address);

/// Serves environments by UDP, as forcebound-server does:
///
///     EnvironmentLibrary environments;
///     environments.add({.name = "spring", .make = ...});
///     UdpServer server(listen({"127.0.0.1", 47800}), {.scene = "spring"}, environments);
///     std::jthread thread([&](const std::stop_token& stop) { server.run(stop); });
///
/// With keys, all sessions are encrypted, and none begins in the clear (secure_link.hpp).
///
/// Single-threaded: environments and the observer are called in the thread that calls `turn` or `run`. A second thread
/// of its own makes newly requested environments meanwhile.
///
/// Real time: a turn with motions alone allocates nothing and waits only for datagrams. Motions are answered before
/// handshakes, of which a turn makes one: however many ask, that delays the answers of all by about 0.2 ms.
class UdpServer {
 public:
  /// @param observer may be null; must outlive the server
  /// @param keys nothing: sessions in the clear, which everybody on the way can read and change
  /// @param mail of all workers, in their order; empty where there is but this one. Must outlive the server
  /// @param moved of all workers; null where there is but this one
  /// @throws std::invalid_argument as Server's and SecureLink's
  UdpServer(net::UdpLink link, const ServerOptions& options, const EnvironmentLibrary& environments,
            ServerObserver* observer = nullptr, std::optional<ServerKeys> keys = std::nullopt,
            std::span<const std::unique_ptr<WorkerMail>> mail = {}, MovedKeys* moved = nullptr);
  UdpServer(const UdpServer&) = delete;
  UdpServer& operator=(const UdpServer&) = delete;

  /// Waits until something comes, for 0.1 s at most, and answers it; a signal ends the wait too.
  void turn();

  /// Calls `turn` until a stop is requested, then `stop`.
  void run(const std::stop_token& wanted);

  /// From now on refuses who asks for a session, with this reason; those that are open go on.
  void admit_none(const std::string& why) { server_.admit_none(why); }

  /// Lets in whom this list has, from now on; ends the sessions and the keys of clients whose key it does not have,
  /// also where another key has their name. Without encryption, and where there was no list, nothing happens.
  void replace_clients(security::AllowedClients clients);

  /// Ends all sessions.
  void stop();

  /// Ends one, at once; false: there is none of that number. Of the thread that calls `turn`.
  bool end_session(std::uint64_t session);

  /// Ends the wait of another worker's `turn`, for it to look at its mail.
  void wake(std::size_t worker) noexcept;

  /// When it last turned; for other threads too.
  [[nodiscard]] Nanoseconds turned() const noexcept { return Nanoseconds{turned_.load(std::memory_order_relaxed)}; }

  /// As they were at most 0.1 s ago, or at the end; for other threads too.
  struct Figures {
    ServerCounters counters{};
    SecureCounters secure{};
    std::size_t sessions = 0;
    double busy = 0;
    std::uint64_t overflowed = 0;       ///< dropped by the system because the socket's buffer was full
    std::uint64_t handed_over = 0;      ///< to other workers
    std::uint64_t not_handed_over = 0;  ///< lost: the other had no room for it
    std::uint64_t keys_not_moved = 0;   ///< lost: the keys of its client had moved too often, or too many had
  };
  [[nodiscard]] Figures figures() const;

  [[nodiscard]] net::Address address() const noexcept { return link_.local_address(); }
  [[nodiscard]] const Server& server() const noexcept { return server_; }
  /// Null: sessions are not encrypted.
  [[nodiscard]] const SecureLink* encryption() const noexcept { return secure_.get(); }

  /// Datagrams that the system dropped because the socket's buffer was full.
  [[nodiscard]] std::uint64_t overflowed() const noexcept { return link_.counters().overflowed; }

 private:
  void receive(std::span<const net::UdpBatch::Arrived> arrived);
  void receive(const net::UdpBatch::Arrived& datagram, Nanoseconds now);
  void receive_own(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now);
  /// True: it was another worker's, or a wake-up call.
  [[nodiscard]] bool was_for_others(const net::UdpBatch::Arrived& datagram) noexcept;
  /// The worker that has the session, of this client, to which what was opened belongs; nothing: none but this can.
  [[nodiscard]] std::optional<std::size_t> owner_of(const SecureLink::Content& content) const noexcept;
  /// @return whether it was taken
  bool hand_over(std::size_t worker, const WorkerMail::Datagram& datagram, SecureLink::Moving* keys = nullptr) noexcept;
  SecureLink::MovedOut hand_over_with_keys(std::size_t worker, const SecureLink::Content& content,
                                           const WorkerMail::Datagram& datagram, Nanoseconds now) noexcept;
  void receive_mail();
  void receive_handed(Nanoseconds now);
  void publish_figures();
  void answer_all();
  void answer_handshake() noexcept;
  void update_busy(Nanoseconds waited) noexcept;

  time::SteadyClock clock_;
  net::UdpLink link_;
  net::UdpBatch batch_{link_};
  std::unique_ptr<SecureLink> secure_;  ///< null: in the clear
  EnvironmentMaker maker_;
  Server server_;
  Nanoseconds timer_;
  // Since `busy_since_`, what came, and the time that was spent waiting.
  std::uint64_t arrived_ = 0;
  Nanoseconds busy_since_{0};
  Nanoseconds waited_{0};
  WorkerPlace place_;
  std::span<const std::unique_ptr<WorkerMail>> mail_;
  WorkerMail::Handed handed_;
  std::uint64_t handed_over_ = 0;
  std::uint64_t not_handed_over_ = 0;
  std::uint64_t keys_not_moved_ = 0;
  std::atomic<std::int64_t> turned_;
  mutable std::mutex figures_guard_;
  Figures figures_;
};

}  // namespace forcebound::server
