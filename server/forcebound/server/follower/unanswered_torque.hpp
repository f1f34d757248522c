#pragma once

#include <array>
#include <optional>

#include "forcebound/device/repeated_readings.hpp"
#include "forcebound/server/robot/robot.hpp"

namespace forcebound::server {

/// Finds out that a robot's readings have frozen: its driver goes on to answer, with new stamps, but tells an old
/// place.
///
/// A robot whose reading repeats itself to the last bit, in all joints, may stand, by friction or for what it touches.
/// What it stood under when its reading last changed (with a sensor, which tells of a while ago, in the 10 ms after
/// that), it goes on to stand under; so it is a *change* of the net torque since then that must move a joint,
///
///     u = distance of tau - J'F to what it was then - T,      F of the tool on its surroundings, if there is a sensor
///     T = max(4 c, tau_max / 5) + 2 k step
///
/// where no joint has more friction than twice its bound c or a tenth of its largest torque, from one side to the
/// other, and nothing that the tool touches is stiffer than k = 5e4 N m/rad unless a sensor tells what it touches
/// (k = 0). By the damping and the inertia of the model (the joint's own, the others held) u turns the joint at least
/// by w: the readings are frozen once that is 10 mrad (10 mm) and ten encoder steps. A robot of which one joint alone
/// freezes is not found out, since the others go on to move it.
///
/// Real time: noexcept, no allocation, O(joints) and once the mass matrix while u > 0. Deterministic.
class UnansweredTorque {
 public:
  /// @param robot its facts and model must outlive this
  explicit UnansweredTorque(const Robot& robot) noexcept;

  /// @param reading usable @param given torques since the reading before
  /// @param sensed force [N] above torque about the tool's point [N m], if there is a sensor
  void update(const device::Reading& reading, const Vector& given, const std::optional<Vector6>& sensed) noexcept;

  /// What was seen so far tells nothing of what comes: its brakes held.
  void restart() noexcept;

  [[nodiscard]] bool frozen() const noexcept { return frozen_; }

 private:
  struct Joint {
    double speed = 0;  ///< that it must have by now [rad/s] or [m/s],
    double way = 0;    ///< and how far it must have gone [rad] or [m]
  };
  [[nodiscard]] double still_s() const noexcept;
  void drive(const Vector& place, const Vector& net, double elapsed_s) noexcept;

  const Robot& robot_;
  Vector least_;    ///< T
  Vector damping_;  ///< largest
  Vector way_;      ///< w
  std::optional<Nanoseconds> latched_{};
  device::RepeatedReadings repeats_;
  Vector lowest_{};   ///< net torque soon after the reading last changed,
  Vector highest_{};  ///< likewise
  std::array<Joint, control::kJointsMax> joints_{};
  bool frozen_ = false;
};

}  // namespace forcebound::server
