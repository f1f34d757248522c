#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/net/udp_batch.hpp"
#include "tests/tools/lab/load/burst.hpp"
#include "tests/tools/lab/load/load_generator.hpp"

namespace forcebound::lab {

struct LoadOptions {
  std::string server;  ///< HOST:PORT
  LoadGenerator::Settings load_generator{};
  Nanoseconds duration{};   ///< of one measurement
  std::size_t sockets = 4;  ///< that the clients share
  enum class Waiting {
    asleep,     ///< for the next motion's time and for answers
    ping_pong,  ///< asleep for answers that are missing, otherwise spinning: as sockperf's ping-pong waits
    spinning,
  };
  Waiting waiting = Waiting::asleep;
  std::optional<int> processor;  ///< to stay on
  std::optional<int> priority;   ///< SCHED_FIFO
};

/// One measurement.
struct LoadResult {
  std::size_t clients = 0;
  std::uint64_t unsent = 0;  ///< motions that this program was too late to send, or the system did not take
  LoadGenerator::Tally tally{};

  [[nodiscard]] std::uint64_t lost() const noexcept { return tally.sent - tally.answered; }
};

/// The clients of a Load generator on real sockets, each at 1 kHz, evenly spread over the millisecond. One thread.
class Load {
 public:
  /// @throws std::runtime_error if there is no way to the server
  explicit Load(const LoadOptions& options);
  ~Load();
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

  /// Measures once with so many clients; those missing connect before it begins, and stay connected.
  /// @throws std::runtime_error if the server refuses or stays silent, with its words
  LoadResult run(std::size_t clients);

 private:
  /// What the clients share: a socket, and room to receive a batch.
  struct Line {
    explicit Line(const net::Address& server) : link(net::UdpLink::towards(server)), batch(link) {}
    net::UdpLink link;
    net::UdpBatch batch;
  };

  void connect(std::size_t clients);
  void receive();
  void take_in(std::span<const net::UdpBatch::Arrived> arrived);
  void rest(Nanoseconds until);  ///< asleep, but for reading
  void wait(Nanoseconds until);  ///< for anything to read, at most so long
  bool send(std::span<const std::byte> datagram, std::size_t client);
  std::uint64_t send_burst(std::size_t client);  ///< how many the system did not take
  [[nodiscard]] Line& line_of(std::size_t client) noexcept;

  LoadOptions options_;
  net::Address server_;
  std::deque<Line> lines_;
  std::vector<int> descriptors_;
  LoadGenerator load_generator_;
  Burst burst_;
};

}  // namespace forcebound::lab
