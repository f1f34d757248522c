#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "forcebound/control/law.hpp"
#include "forcebound/device/choosing_time.hpp"
#include "forcebound/device/haptic_device.hpp"

namespace forcebound::device {

/// When a device was read and commanded, and how far its tip turned, as a law is told of it in control::Motion.
///
/// On each tick, in this order: `begin_choosing`, `motion_at`, `command_at` once the force is chosen, then the device's
/// `apply`.
///
/// Real time: noexcept, no allocation. Not thread-safe; owned by the tick.
class CommandTimes {
 public:
  /// @param device must outlive this
  explicit CommandTimes(const HapticDevice& device)
      : device_(device), choosing_(time::from_seconds(device.facts().period_s)) {}

  void begin_choosing(Nanoseconds now) noexcept { choosing_since_ = now; }

  /// What happened since the tick before, for a reading that is usable or lost.
  [[nodiscard]] control::Motion motion_at(const Reading& reading) const noexcept;

  /// A force chosen on this reading is commanded now: how long after the reading it takes effect [s], by the facts.
  double command_at(const Reading& reading, Nanoseconds now) noexcept;

  /// Whether a tick with this reading commands nothing: it is stale, and the device still holds the force of the last
  /// tick, for 5 ms at most. To a law that tick comes late: the energy of both intervals is known with the next
  /// reading. A zero force would be felt, and the law would have to charge the force for whatever motion there was.
  [[nodiscard]] bool is_held_on(const Reading& reading, Nanoseconds now) const noexcept;

  /// Of the tick before; none: there was none.
  [[nodiscard]] std::optional<Nanoseconds> previous_reading() const noexcept { return previous_reading_; }

 private:
  [[nodiscard]] Vector with_rotations(const Reading& reading) const noexcept;
  [[nodiscard]] double latency_s(Nanoseconds reading_to_command) const noexcept {
    return time::to_seconds(reading_to_command) + device_.facts().latency_s;
  }

  const HapticDevice& device_;
  ChoosingTime choosing_;
  Nanoseconds choosing_since_{0};
  std::optional<Nanoseconds> previous_reading_;
  std::optional<Nanoseconds> previous_command_;
  std::optional<Eigen::Quaterniond> pose_{};              // orientation at the last usable reading
  Eigen::Vector3d turned_rad_ = Eigen::Vector3d::Zero();  // sum of the rotation vectors until then
};

/// A reading that a law may use, or in its place one that is lost: not a number, latched at `now`, and with the reason
/// why it is refused as its status. All that drive a device, or check one, let this decide.
/// @param latest by the caller's clock once the reading was there: none was latched later
[[nodiscard]] Reading usable_or_lost(Reading reading, const control::DeviceFacts& facts, Nanoseconds now,
                                     Nanoseconds latest) noexcept;

}  // namespace forcebound::device
