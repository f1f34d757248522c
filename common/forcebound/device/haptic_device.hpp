#pragma once

#include <optional>

#include "forcebound/control/audit.hpp"
#include "forcebound/control/damping.hpp"
#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::device {

using control::Matrix;
using control::Vector;
using time::Nanoseconds;

/// What the device's encoders say, `dof` rows each. A failed reading is not finite.
struct Reading {
  Vector joint;                               ///< encoder readings [m] or [rad]
  Vector position;                            ///< of the tip, from `joint` by the kinematics [m], scene frame
  Matrix jacobian;                            ///< d position / d joint
  const control::Damping* damping = nullptr;  ///< task-space lower bound here, owned by the device
};

/// A haptic device as the tick sees it.
///
/// Real time: all noexcept, no allocation. Owned by the tick's thread.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  [[nodiscard]] virtual const control::DeviceFacts& facts() const noexcept = 0;

  /// Latches the encoders. `now` never runs backwards.
  virtual Reading read(Nanoseconds now) noexcept = 0;

  /// Commands a tip force, which the motors hold until the next command, but at most for the hold time: the device
  /// layer then zeroes it.
  virtual void apply(Nanoseconds now, const Vector& force_N) noexcept = 0;

  /// The force commanded last was released `when`, or is still held.
  [[nodiscard]] virtual std::optional<Nanoseconds> released_at() const noexcept = 0;

  /// Only simulated devices know.
  [[nodiscard]] virtual std::optional<control::PassivityAudit> audit() const noexcept { return std::nullopt; }
};

}  // namespace forcebound::device
