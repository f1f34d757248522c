#pragma once

#include <cstdint>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::device {

/// How a simulated device truly is, where its facts say otherwise: one that keeps to them has none of it. Brackets are
/// drawn from anew each time, mostly at their ends.
///
/// A law is told of none of it but through the facts' uncertainty; `control::Uncertainty` has the same terms.
struct DeviceFlaws {
  std::uint64_t seed = 1;
  control::Bracket stamp_s{};            ///< a reading is latched so long after its stamp
  control::Bracket latency_s{};          ///< the latency is longer than the facts' by this
  control::Bracket latency_offset_s{};   ///< and by one constant within this
  control::Bracket hold_s{};             ///< each stage of the release comes later by this
  double clock_share = 0;                ///< the caller's clock runs faster than time by this share, slower if negative
  time::Nanoseconds frame{0};            ///< the bus latches and takes in commands only every so often; 0: at once
  double encoder_steps = 0;              ///< a reading is off by up to so many steps before it is rounded
  double lost_counts = 0;                ///< share of the readings at which a joint's encoder loses a count, for good
  double damping_share = 0;              ///< of the damping is missing
  double friction_share = 0;             ///< of the friction is missing
  control::Bracket torque_gain_share{};  ///< each motor's torque is the command times a constant, 1 and so much more
  double torque_ripple_share = 0;        ///< the torque is off by this share, along with the motion
  double actuator_lag_s = 0;             ///< time constant of the torque
  double stale_readings = 0;             ///< share of the readings that are not new
  double failed_writes = 0;              ///< share of the commands that never reach the motors
  bool failures_reported = false;        ///< and the device says so
  bool releases_reported = true;         ///< the device says when a release began
  bool effects_reported = false;         ///< the device says when a force took effect

  friend bool operator==(const DeviceFlaws&, const DeviceFlaws&) = default;
};

/// The bounds within which such a device stays, as a person would write them into its facts: a frame of the bus makes
/// stamps late and latencies long. Lost counts and writes that fail unreported have none.
[[nodiscard]] control::Uncertainty bounds_of(const DeviceFlaws& flaws) noexcept;

}  // namespace forcebound::device
