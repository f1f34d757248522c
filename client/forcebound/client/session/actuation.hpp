#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "forcebound/client/session/device_watch.hpp"
#include "forcebound/client/session/event_reporter.hpp"
#include "forcebound/client/session/hand_safety.hpp"
#include "forcebound/client/session/unseen_energy.hpp"
#include "forcebound/control/audit.hpp"
#include "forcebound/control/force_bounder.hpp"
#include "forcebound/device/command_times.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// The stage of a Session at the device: reads it, and commands what the limits for the hand (HandSafety) and the law
/// (ForceBounder) leave of the force that is asked for.
///
/// On each tick, in this order: `read`, `begin_choosing`, `command`. Reports a device that is gone or back, that shows
/// no torque though its handle turns, and limits for the hand that begin to act.
///
/// After an unusable reading the device's state is unknown: the law charges the worst case of the applied force, and
/// gives zero force.
///
/// Real time: noexcept, no allocation, but for the constructor and `add_to`.
class Actuation {
 public:
  /// @param device, @param clock and @param events must outlive this
  /// @throws std::invalid_argument if ForceBounder refuses the device or law
  Actuation(device::HapticDevice& device, std::unique_ptr<control::PassivityLaw> law, const time::Clock& clock,
            EventReporter& events);

  /// A reading that is usable or lost; none: there is no new one, and the device still holds the force of the last tick
  /// (CommandTimes), so that this tick commands nothing.
  [[nodiscard]] std::optional<device::Reading> read(Nanoseconds now) noexcept;

  /// The force of this reading is chosen from now on. @returns the time since the reading before [s]; zero on the first
  /// tick
  [[nodiscard]] double begin_choosing(const device::Reading& reading) noexcept;

  struct Wanted {
    const Vector& force_N;              ///< a row for each translation
    const Eigen::Vector3d& torque_N_m;  ///< about the grip, where the device shows it
    bool silent = false;                ///< nobody asks for a force: it is zero whatever the law would give
  };

  struct Command {
    Vector request_N{};           ///< asked of the law: what the limits for the hand leave
    Vector request_torque_N_m{};  ///< likewise; no rows: the device shows none
    Vector applied_N{};
    Vector applied_torque_N_m{};                     ///< no rows: the device shows none
    Nanoseconds interval{0};                         ///< since the reading before; zero on the first tick
    Nanoseconds latency{0};                          ///< from the reading to the command
    double energy_J = 0;                             ///< that the law may spend now
    double xi = 1;                                   ///< of the law
    std::optional<control::PassivityAudit> audit{};  ///< of a simulated device
  };

  /// Commands the device.
  Command command(Nanoseconds now, const device::Reading& reading, const Wanted& wanted) noexcept;

  /// Zero force, as the session is over.
  void stop(Nanoseconds now) noexcept { device_.stop(now); }

  /// What the server-side law said with the newest force, ahead of the tick that uses that force.
  void receive(const control::ServerLawNumbers& numbers) noexcept { bounder_.receive(numbers); }
  /// From now on another server answers, or the same one after a restart.
  void begin_server_side() noexcept { bounder_.begin_server_side(); }

  [[nodiscard]] const control::PassivityLaw& law() const noexcept { return bounder_.law(); }

  /// Adds counts of the device, the law and the limits for the hand.
  void add_to(record::RunTotals& totals) const;

 private:
  struct Counts {
    std::uint64_t held_too_long = 0;
    std::uint64_t released_by_device = 0;
    std::uint64_t stale_readings = 0;
    control::ReadingCounts readings{};
  };

  [[nodiscard]] Nanoseconds interval_until(const device::Reading& reading) const noexcept;
  void report_presence(device::Reading::Status status, Nanoseconds now) noexcept;
  void report_missing_torque(const device::Reading& reading, Nanoseconds now) noexcept;
  void limit_for_hand(Nanoseconds now, const device::Reading& reading, const Wanted& wanted, Command& command) noexcept;
  [[nodiscard]] Vector chosen(const device::Reading& reading, const Command& command, bool silent) noexcept;

  device::HapticDevice& device_;
  const time::Clock& clock_;
  EventReporter& events_;
  control::ForceBounder bounder_;
  device::CommandTimes times_;
  DeviceWatch watch_;
  HandSafety safety_;
  UnseenEnergy unseen_;
  Vector last_applied_;  // force, and torque where the device shows it
  bool missing_torque_reported_ = false;
  Counts counts_;
};

}  // namespace forcebound::client
