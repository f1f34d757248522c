#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "tests/tools/relay/packet_rows.hpp"
#include "tests/tools/relay/relay.hpp"

namespace forcebound::relay {

/// Rows of a log that reached its file, and missing ones.
struct LogResult {
  std::uint64_t written = 0;
  std::uint64_t missing = 0;  ///< rows that could not be written
  std::string problem;        ///< the reason; empty if nothing is missing
};

/// Writes a relay's log in a thread of its own, so that no disk delays a packet.
///
/// The relay hands rows over through a bounded lock-free queue; if that is full they are counted as missing. So are
/// all rows after the disk refuses one.
class LogWriter final : public PacketObserver {
 public:
  /// @param incomplete called by the thread that writes, once, as soon as rows are missing, with the reason; may be
  /// empty
  /// @throws std::runtime_error if the file cannot be created.
  LogWriter(const std::string& file, Nanoseconds start, std::function<void(const std::string& why)> incomplete = {});
  ~LogWriter() override;
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  void on_verdict(Direction direction, const netem::Verdict& verdict) noexcept override;
  void on_departure(Direction direction, const netem::Verdict& verdict) noexcept override;

  /// Writes the remaining rows and closes the file. Once, after the last packet.
  LogResult finish();

 private:
  struct Event {
    netem::Verdict verdict;
    Direction direction;
    bool departed;
  };
  static constexpr std::size_t kEventsMax = std::size_t{1} << 16U;

  void run();
  void drain();
  void write(std::size_t rows);
  bool write_text();
  [[nodiscard]] std::string problem() const;
  void report_if_incomplete();

  int file_;
  PacketRows rows_;
  boost::lockfree::spsc_queue<Event> events_{kEventsMax};
  std::atomic<std::uint64_t> verdicts_refused_{0};  // by a full queue; counted by the relay's side
  std::string text_;
  LogResult result_;
  std::function<void(const std::string&)> incomplete_;  // empty once it has been called
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace forcebound::relay
