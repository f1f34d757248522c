#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/client/device/simulated_device.hpp"
#include "forcebound/client/session/session.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/server/session/server.hpp"
#include "tests/sim/simulated_network.hpp"
#include "tests/sim/virtual_clock.hpp"

namespace forcebound::sim {

/// One client and one server, the very code of the programs, over the simulated network in virtual time:
///
///     hand -- device -- client session ==( impaired up / down )== server -- scene
///
/// Ticks are punctual, the server takes no time. Everything follows from the settings: same settings, same run.
class ClosedLoop {
 public:
  struct Settings {
    client::DeviceDescription device;
    std::string hand;  ///< the operator's specification
    std::string law;
    std::shared_ptr<const server::Scene> scene;
    SimulatedNetworkSettings network{};
    client::LateForcePolicy policy{};
    std::uint64_t seed = 1;
    double settle_s = 0;  ///< contact statistics begin this long after the first contact
  };

  /// @param sinks see every tick, beside the summary; they must outlive the loop.
  /// @throws what device, operator, law and scene refuse.
  explicit ClosedLoop(Settings settings, const std::vector<record::TickSink*>& sinks = {});

  ~ClosedLoop();
  ClosedLoop(const ClosedLoop&) = delete;
  ClosedLoop& operator=(const ClosedLoop&) = delete;

  /// Ticks for so long.
  void run(Nanoseconds duration);

  /// The client does nothing for so long: its next tick is late by it.
  void stall(Nanoseconds duration) noexcept { next_tick_ += duration; }

  /// Ends the session as the program does and gives the summary of all.
  const record::Summary& close();

  void kill_server();
  void start_server();

  [[nodiscard]] const client::SimulatedDevice& device() const noexcept { return device_; }
  [[nodiscard]] const client::Session& session() const noexcept { return *session_; }
  [[nodiscard]] SimulatedNetwork& network() noexcept { return network_; }
  [[nodiscard]] const server::Server* server() const noexcept { return server_.get(); }
  [[nodiscard]] record::RunTotals totals() const { return session_->totals(); }

 private:
  void live_until(Nanoseconds time);
  [[nodiscard]] record::RunInfo info() const;

  Settings settings_;
  VirtualClock clock_;
  SimulatedNetwork network_;
  client::SimulatedDevice device_;
  record::Summary summary_;
  std::vector<record::TickSink*> sinks_;
  std::unique_ptr<client::Session> session_;
  std::unique_ptr<server::Server> server_;
  std::uint64_t server_starts_ = 0;
  Nanoseconds period_;
  Nanoseconds next_tick_{0};
};

}  // namespace forcebound::sim
