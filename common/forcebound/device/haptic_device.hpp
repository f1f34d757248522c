#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "forcebound/control/audit.hpp"
#include "forcebound/control/damping.hpp"
#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/handle.hpp"
#include "forcebound/control/reading_status.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/device/safety.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::device {

using control::Handle;
using control::Matrix;
using control::Vector;
using time::Nanoseconds;

/// One reading of the device's encoders; the position of the tip has a row for each translation, the Jacobian for each
/// degree of freedom. The orientation of a tip that turns is the handle's.
///
/// Only an `ok` reading is used. A stale reading does not mean that the device stands still: its motion since then is
/// unknown, so a law must charge the worst case.
struct Reading {
  using Status = control::ReadingStatus;

  Vector joint;                               ///< encoder readings [m] or [rad], a row for each joint
  Vector position;                            ///< of the tip, from `joint` by the kinematics [m], scene frame
  Matrix jacobian;                            ///< d position / d joint; below it, of the angular velocity, scene frame
  const control::Damping* damping = nullptr;  ///< task-space lower bound here, owned by the device
  Nanoseconds latched{0};                     ///< stamp of the encoders' sampling, caller's clock
  Status status = Status::ok;
  Handle handle{};  ///< buttons, gripper and orientation, where there are any; all that is there can be true
};

/// Whether a law may use it, whenever it was latched: what the device says, and else finite numbers of the right sizes.
[[nodiscard]] inline Reading::Status status_of(const Reading& reading, int degrees_of_freedom, int joints,
                                               int rotations = 0) noexcept {
  if (reading.status != Reading::Status::ok) return reading.status;
  if (rotations > 0 && !reading.handle.orientation) return Reading::Status::no_orientation;
  const auto fits = [](const auto& rows, int expected) { return rows.rows() == expected && rows.allFinite(); };
  const bool complete = fits(reading.position, degrees_of_freedom - rotations) && fits(reading.joint, joints) &&
                        fits(reading.jacobian, degrees_of_freedom) && reading.jacobian.cols() == joints &&
                        reading.damping != nullptr;
  return complete ? Reading::Status::ok : Reading::Status::incomplete;
}
[[nodiscard]] inline bool is_usable(const Reading& reading, int degrees_of_freedom, int joints,
                                    int rotations = 0) noexcept {
  return status_of(reading, degrees_of_freedom, joints, rotations) == Reading::Status::ok;
}
/// As above, of a device with these facts.
[[nodiscard]] inline bool is_usable(const Reading& reading, const control::DeviceFacts& facts) noexcept {
  return is_usable(reading, facts.degrees_of_freedom(), facts.joints(), facts.rotations);
}
/// As above, with as many joints as degrees of freedom.
[[nodiscard]] inline bool is_usable(const Reading& reading, int degrees_of_freedom) noexcept {
  return is_usable(reading, degrees_of_freedom, degrees_of_freedom);
}

/// Faults at the device since `start`, for reports.
struct DeviceCounters {
  std::uint64_t faulty_commands = 0;  ///< not finite or of the wrong size, shown as zero
  std::uint64_t failed_writes = 0;    ///< commands that may not have reached the motors
  std::uint64_t frozen_joints = 0;    ///< simulated: more stick-slip events in 1 ms than it resolves
  std::uint64_t gaps_cut = 0;         ///< simulated: pauses between two calls too long to simulate in full
  std::uint64_t handle_refused = 0;   ///< orientations and gripper openings that cannot be true: taken for absent
  std::uint64_t unexplained = 0;      ///< failed calls for which the driver gave no reason
};

/// A haptic device, real or simulated. The client's tick uses one to push a person's hand; a robot at the server is
/// driven through the same interface.
///
/// Order of calls: `start`, then `read` and `apply` in turn, at last `stop`. An implementation must keep to its facts,
/// because every passivity guarantee rests on them: the device dissipates at least the facts' damping, and releases the
/// force after the hold time if the facts say so.
///
/// Real time: `read`, `apply`, `stop` and the queries that are noexcept allocate nothing and wait no longer than the
/// bus needs. Used by one thread; after `start` by the tick's thread.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  [[nodiscard]] virtual const control::DeviceFacts& facts() const noexcept = 0;

  /// Whether it is a simulation, which no person feels.
  [[nodiscard]] virtual bool is_simulated() const noexcept { return false; }

  /// Whether its facts were measured on it or promised by its maker; false: they are guesses, and what a law promises
  /// with them is one too. A simulation has exactly its facts.
  [[nodiscard]] virtual bool bounds_are_identified() const noexcept { return true; }

  /// Its facts in one line, each number with its unit.
  [[nodiscard]] virtual std::string facts_in_words() const;

  /// The simulated hand that moves it, with its parameters; empty: a person moves it, or that is unknown.
  [[nodiscard]] virtual std::string hand_in_words() const { return {}; }

  /// Limits for the hand on it. A person's are on unless the device says otherwise; a simulated hand has none.
  [[nodiscard]] virtual Safety safety() const noexcept {
    return is_simulated() ? Safety{} : Safety::of_a_person(facts());
  }

  /// Makes it ready; the force is zero until the first command.
  /// @throws std::runtime_error naming what is missing.
  virtual void start() {}

  /// Latches the encoders. `now` never runs backwards.
  virtual Reading read(Nanoseconds now) noexcept = 0;

  /// Commands a tip force, and below it a torque if the device has rotations [N], [N m], which the motors hold until
  /// the next command, but at most for the hold time: the device layer then releases it, in the facts' stages.
  virtual void apply(Nanoseconds now, const Vector& force_N) noexcept = 0;

  /// Commands zero force at once. Called at the end; when an assertion fails, then in any state and on any thread; and
  /// unless it is simulated, when the tick has not run for the time that a force is held, then on another thread.
  virtual void stop(Nanoseconds now) noexcept { apply(now, Vector::Zero(facts().degrees_of_freedom())); }

  /// When the last commanded force took effect at the motors, by the caller's clock; none: the device cannot tell, and
  /// the facts' latency holds.
  [[nodiscard]] virtual std::optional<Nanoseconds> effective_at() const noexcept { return std::nullopt; }

  /// Whether the last command may not have reached the motors, so that they may hold the one before it.
  [[nodiscard]] virtual bool write_failed() const noexcept { return false; }

  /// When the device layer began to release the last commanded force, by the caller's clock, however early; none: it is
  /// still held.
  [[nodiscard]] virtual std::optional<Nanoseconds> released_at() const noexcept = 0;

  /// Ground-truth energy balance; only simulated devices have one.
  [[nodiscard]] virtual std::optional<control::PassivityAudit> audit() const noexcept { return std::nullopt; }

  [[nodiscard]] virtual DeviceCounters counters() const noexcept { return {}; }

  /// Reason of the latest failed reading or command, for reports; empty: none failed.
  [[nodiscard]] virtual std::string_view last_error() const noexcept { return {}; }

  /// How its driver crashed, in words, once it was stopped after that; empty: it did not. The program is to end then.
  /// Any thread.
  [[nodiscard]] virtual std::string_view crash() const noexcept { return {}; }
};

}  // namespace forcebound::device
