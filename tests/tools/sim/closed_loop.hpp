#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "forcebound/client/session/session.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/server/session/server.hpp"
#include "tests/tools/sim/busy_server.hpp"
#include "tests/tools/sim/environment.hpp"
#include "tests/tools/sim/misdescribed_device.hpp"
#include "tests/tools/sim/simulated_network.hpp"
#include "tests/tools/sim/skewed_clock.hpp"
#include "tests/tools/sim/tick_schedule.hpp"
#include "tests/tools/sim/true_surface.hpp"
#include "tests/tools/sim/virtual_clock.hpp"

namespace forcebound::sim {

/// One client and one server, the very code of the programs, over the simulated network in virtual time:
///
///     hand -- device -- client session ==( impaired up / down )== server -- environment -- scene
///         ticks late or not     |                             another clock  (may lie)
///                            ledger
///
/// The server takes only the time in the settings. Everything follows from the settings: same settings, same run.
class ClosedLoop {
 public:
  /// A temporary fault, effective from the first tick after its beginning.
  struct Fault {
    enum class Kind : std::uint8_t {
      stall,          ///< the client does nothing
      blackout_up,    ///< what the client sends is lost
      blackout_down,  ///< what the server sends is lost
      blackout,       ///< both
      server_killed,  ///< and restarted afterwards
    };
    Kind kind = Kind::stall;
    Nanoseconds at{0};
    Nanoseconds length{0};
  };

  struct Settings {
    device::DeviceDescription device;
    std::string hand;                                                      ///< the operator's specification
    std::function<std::unique_ptr<const device::Operator>()> make_hand{};  ///< replaces it, if set
    std::string law;
    std::shared_ptr<const scene::Scene> scene;  ///< null: `own_environment`, under its own name
    SimulatedNetworkSettings network{};
    client::LateForcePolicy policy{};
    std::uint64_t seed = 1;
    double settle_s = 0;  ///< contact statistics begin this long after the first contact
    TickTiming timing{};
    ClockSkew server_clock{};
    device::DeviceFlaws flaws{};                      ///< how the device truly is
    std::optional<control::DeviceFacts> told{};       ///< what the client is told of it; none: the truth
    std::optional<EnvironmentSetting> environment{};  ///< none: the scene
    /// The server's in place of the scene, of which only name and degrees of freedom count then; its surface is known
    /// from its answers alone.
    std::optional<server::EnvironmentKind> own_environment{};
    std::vector<Fault> faults{};
    Nanoseconds server_turn{0};                          ///< computing time before it answers; datagrams wait meanwhile
    std::shared_ptr<const control::LawRegistry> laws{};  ///< of both ends; null: the shipped ones
    control::LawOptions law_options{};
    bool renders_locally = false;  ///< the static parts of the scene run at the client
    /// Handed over in place of the scene, by a server that lies; null: the scene.
    std::shared_ptr<const scene::Scene> handed_over{};
    std::string scene_cache{};      ///< folder; empty: none
    double force_slew_N_per_s = 0;  ///< 0: no bound
    client::SendRate send_rate{};
    server::HandoverRate handover{};
  };

  /// @param sinks see every tick, beside the summary, with the depth below the true surface (TrueSurface); they must
  /// outlive the loop.
  /// @throws what device, operator, law and scene refuse.
  explicit ClosedLoop(Settings settings, const std::vector<record::TickSink*>& sinks = {});

  ~ClosedLoop();
  ClosedLoop(const ClosedLoop&) = delete;
  ClosedLoop& operator=(const ClosedLoop&) = delete;

  /// Runs for that time.
  void run(Nanoseconds duration) { run_until(std::max(end_, next_tick_) + duration); }

  /// Runs until then, since the beginning; not at all if that is over. In parts it is the same run as in one.
  void run_until(Nanoseconds end);

  /// The client pauses for that time: its next tick is late by it.
  void stall(Nanoseconds duration) noexcept { next_tick_ += duration; }

  /// The beginning of the last tick.
  [[nodiscard]] Nanoseconds time() const noexcept { return clock_.now(); }

  /// Ends the session as the program does and returns the summary.
  const record::Summary& close();

  /// Of the ticks so far, without the totals of a session that has ended.
  [[nodiscard]] const record::Summary& summary() const noexcept { return summary_; }

  void kill_server();
  void start_server();

  [[nodiscard]] const device::SimulatedDevice& device() const noexcept { return device_; }
  [[nodiscard]] const client::Session& session() const noexcept { return *session_; }
  [[nodiscard]] SimulatedNetwork& network() noexcept { return network_; }
  [[nodiscard]] const server::Server* server() const noexcept { return server_.get(); }
  [[nodiscard]] record::RunTotals totals() const { return session_->totals(); }

  /// Null where all forces are the server's.
  [[nodiscard]] client::LocalRendering* local() noexcept { return local_ ? &*local_ : nullptr; }

 private:
  [[nodiscard]] device::HapticDevice& device_as_described() noexcept {
    if (described_) return *described_;
    return device_;
  }
  void live_until(Nanoseconds time);
  void end_server_turn();
  void plan_next_tick();
  void build_scene();
  void apply_faults();
  [[nodiscard]] Truth truth() const;
  [[nodiscard]] record::RunInfo info() const;

  Settings settings_;
  VirtualClock clock_;
  TickClock tick_clock_;
  SkewedClock server_clock_;
  TickSchedule schedule_;
  SimulatedNetwork network_;
  BusyServer busy_;
  device::SimulatedDevice device_;
  std::optional<MisdescribedDevice> described_;
  TrueSurface surface_;
  record::Summary summary_;
  std::array<record::TickSink*, 1> session_sinks_{&surface_};
  std::optional<client::LocalRendering> local_;
  std::unique_ptr<client::Session> session_;
  std::unique_ptr<server::Server> server_;
  std::uint64_t server_starts_ = 0;
  Nanoseconds next_tick_{0};
  Nanoseconds free_{0};  // the end of the client's tick
  Nanoseconds end_{0};
  Nanoseconds next_timer_{0};
  Nanoseconds next_build_{0};
};

}  // namespace forcebound::sim
