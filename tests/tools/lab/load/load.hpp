#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/client/runtime/encryption.hpp"
#include "forcebound/client/security/identity_files.hpp"
#include "forcebound/net/udp_batch.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/tools/lab/load/burst.hpp"
#include "tests/tools/lab/load/load_generator.hpp"

namespace forcebound::lab {

struct LoadOptions {
  std::string server;                ///< HOST:PORT
  client::IdentityFiles identity{};  ///< keys; none: not encrypted
  LoadGenerator::Settings load_generator{};
  Nanoseconds duration{};   ///< of one measurement
  std::size_t sockets = 4;  ///< shared by the clients
  enum class Waiting {
    asleep,     ///< for the next motion's time and for answers
    ping_pong,  ///< asleep while answers are missing, otherwise spinning: as in sockperf's ping-pong
    spinning,
  };
  Waiting waiting = Waiting::asleep;
  std::optional<int> processor;  ///< to be pinned to
  std::optional<int> priority;   ///< SCHED_FIFO
};

/// One measurement.
struct LoadResult {
  std::size_t clients = 0;
  std::uint64_t unsent = 0;  ///< motions that this program was too late to send, or the system did not take
  LoadGenerator::Tally tally{};
  LoadGenerator::HandedOver handed_over{};  ///< of all measurements so far

  [[nodiscard]] std::uint64_t lost() const noexcept { return tally.sent - tally.answered; }
};

/// The clients of a LoadGenerator on real sockets, each at 1 kHz, evenly spread over the millisecond. One thread.
class Load {
 public:
  /// @throws std::runtime_error if the server's address cannot be reached
  explicit Load(const LoadOptions& options);
  ~Load();
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

  /// Measures once with that number of clients; missing ones connect first, get the scene if they render locally, and
  /// stay connected.
  /// @throws std::runtime_error if the server refuses, with its reason, or does not answer
  LoadResult run(std::size_t clients);

 private:
  /// Shared by several clients: a socket, and room to receive a batch.
  struct Line {
    Line(const net::Address& server, const LoadOptions& options, const time::Clock& clock);
    net::UdpLink link;
    net::UdpBatch batch;
    std::unique_ptr<client::Encryption> encryption;  ///< null: none
  };

  void connect(std::size_t clients);
  void receive_scene(std::size_t clients);
  void receive();
  void receive_arrived(Line& line, std::span<const net::UdpBatch::Arrived> arrived);
  /// If its line is encrypted, else as it is; valid until the next is asked for.
  [[nodiscard]] std::span<const std::byte> sealed(std::span<const std::byte> datagram, std::size_t client) noexcept;
  void rest(Nanoseconds until);  ///< asleep, but for reading
  void wait(Nanoseconds until);  ///< for anything to read, at most until then
  bool send(std::span<const std::byte> datagram, std::size_t client);
  std::uint64_t send_burst(std::size_t client);  ///< how many the system did not take
  [[nodiscard]] Line& line_of(std::size_t client) noexcept;

  LoadOptions options_;
  time::SteadyClock clock_;
  net::Address server_;
  std::deque<Line> lines_;
  std::vector<int> descriptors_;
  LoadGenerator load_generator_;
  Burst burst_;
  std::array<std::byte, net::kDatagramBytesMax> opened_{};
  std::uint64_t given_up_ = 0;  ///< answers missing when the next motion was due; `rest` sleeps no longer for them
};

}  // namespace forcebound::lab
