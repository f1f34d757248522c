#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include "forcebound/server/offer/environment.hpp"
#include "forcebound/server/runtime/udp_server.hpp"
#include "forcebound/server/security/key_files.hpp"

namespace forcebound::server {

/// A server of one environment within another program, on a thread of its own, in which nothing of another language
/// runs unless the environment does. Of this forcebound-ros2's, Python's and C's are made. It runs once. Any thread.
class EmbeddedServer {
 public:
  struct Settings {
    std::string listen = "127.0.0.1:47800";  ///< HOST:PORT; port 0: a free one
    KeyFiles keys{};
    ServerOptions options{};             ///< the scene is filled in
    ServerObserver* observer = nullptr;  ///< called in the server's thread; must outlive it
    int priority = 0;         ///< of that thread, 1 to 99, by SCHED_FIFO if the system grants it; 0: as others
    bool by_options = false;  ///< refusals name options of a command line; false: these settings
  };

  /// Takes the address, reads the keys.
  /// @param simulated in one line for people
  /// @throws std::invalid_argument, config::ConfigError or std::runtime_error what address and keys are refused for
  EmbeddedServer(const Settings& settings, const EnvironmentKind& kind, std::string simulated);

  /// @returns false: it was started before
  [[nodiscard]] bool start();

  enum class Stopped : std::uint8_t { now, with_failure, never_started, not_by_itself };

  /// Says good-bye to all clients, and waits for the thread, which cannot do that.
  [[nodiscard]] Stopped stop();

  [[nodiscard]] bool is_running() const noexcept { return running_; }
  /// Why the thread ended by itself; empty: it did not.
  [[nodiscard]] std::string failure() const;
  [[nodiscard]] net::Address address() const noexcept { return server_.address(); }
  /// As server::encryption_in_words.
  [[nodiscard]] const std::string& encryption_in_words() const noexcept { return encryption_in_words_; }
  [[nodiscard]] UdpServer::Figures figures() const { return server_.figures(); }

  struct OwnCount {
    std::string_view name;
    std::uint64_t count = 0;
  };

  /// JSON: what it serves, and every count that forcebound-server prints at its end.
  [[nodiscard]] std::string summary(std::string_view program, std::span<const OwnCount> own) const;

 private:
  struct Reached {
    net::Address address{};
    std::optional<ServerKeys> keys{};
  };
  [[nodiscard]] static Reached reached_by(const Settings& settings, const std::string& scene);

  EmbeddedServer(const Settings& settings, const EnvironmentKind& kind, std::string simulated, Reached reached);

  void run(const std::stop_token& wanted);

  const std::string name_;
  const std::string simulated_;
  const std::string encryption_;
  const std::string encryption_in_words_;
  const int priority_;
  UdpServer server_;
  mutable std::mutex mutex_;  // of what follows, but `running_`
  bool started_ = false;
  std::string failure_;
  std::atomic<bool> running_{false};
  std::atomic<std::thread::id> runs_on_{};
  std::mutex ending_;    // of who waits for the thread
  std::jthread thread_;  // last: ends before what it uses
};

}  // namespace forcebound::server
