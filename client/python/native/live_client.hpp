#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "forcebound/client/embedding/embedded_client.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "python/native/tables.hpp"

namespace forcebound::python {

/// Keeps ticks for another thread to look at while more come: a fixed number of rows, of which those that are counted
/// do not change any more. Further ticks are counted, and not kept.
///
/// Real time: `on_tick` is noexcept, allocates nothing and never waits.
class KeptTicks final : public record::TickSink {
 public:
  /// Touches all of its memory, so that the tick does not have to.
  KeptTicks(RowShape shape, std::size_t rows_max);

  void on_tick(const record::TickRecord& tick) noexcept override;

  /// A copy of the rows from `first` on.
  [[nodiscard]] py::array since(std::size_t first) const;
  [[nodiscard]] std::size_t kept() const noexcept { return kept_.load(std::memory_order_acquire); }
  [[nodiscard]] std::size_t not_kept() const noexcept { return not_kept_.load(std::memory_order_relaxed); }

 private:
  RowsOf<record::TickRecord> layout_;
  std::size_t rows_max_;
  std::vector<std::byte> bytes_;
  std::atomic<std::size_t> kept_{0};
  std::atomic<std::size_t> not_kept_{0};
};

/// The client of the programs with a simulated device and hand: what its ticks saw is looked at from outside.
class LiveClient {
 public:
  struct Settings {
    client::Client::Settings client;
    control::LawOptions law_options;
    device::DeviceDescription device;
    std::size_t ticks_kept = 0;
  };
  /// @throws what device, hand, law and client::Client refuse
  explicit LiveClient(const Settings& settings);

  /// Runs until its time is up, it gives up, or `stop`. Once. Other Python threads run meanwhile.
  /// @throws std::runtime_error for a second time, and what client::Client::run does
  void run() { client_.run(); }

  /// Any thread.
  void stop() noexcept { client_.stop(); }

  [[nodiscard]] const KeptTicks& ticks() const noexcept { return ticks_; }

  /// What went wrong on the way: keys, handshakes, the recording. Any thread.
  [[nodiscard]] std::vector<std::string> problems() const;

  /// After `run`: JSON.
  [[nodiscard]] std::string summary() const { return client_.summary(); }

  /// After `run`: why there was no session; empty: there was one.
  [[nodiscard]] std::string why_no_session() const { return client_.why_no_session(); }

 private:
  void keep(const std::string& problem);

  device::SimulatedDevice device_;
  KeptTicks ticks_;
  mutable std::mutex mutex_;
  std::vector<std::string> problems_;
  client::EmbeddedClient client_;
};

}  // namespace forcebound::python
