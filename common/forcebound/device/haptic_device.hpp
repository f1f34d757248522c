#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "forcebound/control/audit.hpp"
#include "forcebound/control/damping.hpp"
#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::device {

using control::Matrix;
using control::Vector;
using time::Nanoseconds;

/// What the device's encoders say, `dof` rows each.
///
/// Only a reading that is `ok` is used. A stale one is no reading of a device that stands still: what its force did
/// since is unknown, and a law has to charge the worst.
struct Reading {
  enum class Status : std::uint8_t {
    ok,
    failed,  ///< the device gave none
    stale,   ///< encoders as latched for an earlier reading
  };

  Vector joint;                               ///< encoder readings [m] or [rad]
  Vector position;                            ///< of the tip, from `joint` by the kinematics [m], scene frame
  Matrix jacobian;                            ///< d position / d joint
  const control::Damping* damping = nullptr;  ///< task-space lower bound here, owned by the device
  Nanoseconds latched{0};                     ///< when the encoders were where they say, by the caller's clock
  Status status = Status::ok;
};

/// Whether a law may use it: ok, and finite numbers of the right sizes.
[[nodiscard]] inline bool is_usable(const Reading& reading, int degrees_of_freedom) noexcept {
  const auto fits = [degrees_of_freedom](const auto& rows) {
    return rows.rows() == degrees_of_freedom && rows.allFinite();
  };
  return reading.status == Reading::Status::ok && fits(reading.position) && fits(reading.joint) &&
         fits(reading.jacobian) && reading.jacobian.cols() == degrees_of_freedom && reading.damping != nullptr;
}

/// What went wrong at the device since the start, for people.
struct DeviceCounters {
  std::uint64_t faulty_commands = 0;  ///< not finite or of the wrong size, shown as zero
  std::uint64_t frozen_joints = 0;    ///< simulated: more stick-slip events in a ms than it follows
  std::uint64_t gaps_cut = 0;         ///< simulated: pauses between two calls that it did not live through in full
};

/// A haptic device, real or simulated: what the client's tick moves a person's hand with, and a robot at the server
/// its tool.
///
/// Order of calls: `start`, then `read` and `apply` in turn, at last `stop`. Whoever makes one keeps to its facts, on
/// which every promise of passivity rests: it dissipates at least the facts' damping, and lets go after the hold time
/// where the facts say so.
///
/// Real time: `read`, `apply`, `stop` and the queries that are noexcept allocate nothing and wait no longer than the
/// bus needs. Owned by one thread, after `start` by the tick's.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  [[nodiscard]] virtual const control::DeviceFacts& facts() const noexcept = 0;

  /// Whether no person can feel it.
  [[nodiscard]] virtual bool is_simulated() const noexcept { return false; }

  /// Its facts in one line, each number with its unit.
  [[nodiscard]] virtual std::string facts_in_words() const;

  /// The simulated hand that moves it, with its numbers; empty: a person does, or nobody knows.
  [[nodiscard]] virtual std::string hand_in_words() const { return {}; }

  /// Makes it ready; the force is zero until the first command.
  /// @throws std::runtime_error saying what is missing.
  virtual void start() {}

  /// Latches the encoders. `now` never runs backwards.
  virtual Reading read(Nanoseconds now) noexcept = 0;

  /// Commands a tip force, which the motors hold until the next command, but at most for the hold time: the device
  /// layer then zeroes it.
  virtual void apply(Nanoseconds now, const Vector& force_N) noexcept = 0;

  /// Zero force at once. Called at the end, and before the program gives up on a bug of its own: then from whatever
  /// state, and on whatever thread found the bug.
  virtual void stop(Nanoseconds now) noexcept { apply(now, Vector::Zero(facts().degrees_of_freedom())); }

  /// The force commanded last was released `when`, or is still held.
  [[nodiscard]] virtual std::optional<Nanoseconds> released_at() const noexcept = 0;

  /// Only simulated devices know.
  [[nodiscard]] virtual std::optional<control::PassivityAudit> audit() const noexcept { return std::nullopt; }

  [[nodiscard]] virtual DeviceCounters counters() const noexcept { return {}; }

  /// Why a reading or command failed last, for people; empty: none did.
  [[nodiscard]] virtual std::string_view last_error() const noexcept { return {}; }
};

}  // namespace forcebound::device
