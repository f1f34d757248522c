#pragma once

#include <array>
#include <cstddef>

#include "forcebound/device/repeated_readings.hpp"
#include "forcebound/server/robot/robot.hpp"

namespace forcebound::server {

/// Bounds how far a robot turns whose readings have frozen while its driver goes on to answer, and finds out that they
/// have.
///
/// A joint whose reading repeats itself may stand, by friction or for what it touches. What it stood under when its
/// reading last changed, it goes on to stand under; so it is a *change* of the net torque since then that may move it,
///
///     u = |(tau - J'F) - (tau - J'F)_0| - c,        F of the tool on its surroundings, if there is a sensor
///
/// with the friction bound c. A joint that was on its way then (RepeatedReadings) stood under nothing: for it the net
/// torque counts in full, and its way at that speed besides. By the damping bound b, which all motion must pay for,
/// the torques since the last change turn it, until it is at rest again, no further than
///
///     way <= (integral of u) / b + v t
///
/// From 0.015 rad of that on, the torque is drawn back to the one under which it stood, and at 0.03 rad is that one.
/// So a joint that sticks more firmly than its friction bound says goes on to stick, and a frozen one stops.
///
/// A change beyond `T` has an allowance of its own, so that a joint that sticks is broken loose, and when that is used
/// up, or after 0.2 s, the joint does not answer a force that must have moved it: its readings are frozen. With the
/// largest torque of the joint
///
///     T = max(4 c, tau_max / 5) + 2 k step
///
/// holds that no joint has more friction than twice its bound or a tenth of its torque, from one side to the other, and
/// that nothing which the tool touches is stiffer than k = 5e4 N m/rad, unless a sensor tells what it touches (k = 0).
/// Where T is above the largest torque, nothing is ever said to be frozen, but the torque is still drawn back. Frozen
/// is, too, what cannot have stopped as it did: the tool may be stopped with four times the largest torque.
///
/// Real time: noexcept, no allocation, O(joints) but for the tick on which a moving joint stops. Deterministic.
class JointAnswers {
 public:
  /// @param robot its facts and model must outlive this
  explicit JointAnswers(const Robot& robot) noexcept;

  /// @param reading usable @param given torques since the reading before
  void note(const device::Reading& reading, const Vector& given) noexcept;

  /// What may be asked of a robot with the readings so far.
  [[nodiscard]] Vector limited(const Vector& torque) noexcept;

  /// A joint does not answer.
  [[nodiscard]] bool frozen() const noexcept { return frozen_; }

  /// Its brakes hold: what it does not do then tells nothing.
  void restart() noexcept;

 private:
  struct Joint {
    double net = 0;           ///< torque under which it stood when its reading last changed, less what it touched
    double torque = 0;        ///< of it what was given
    double way = 0;           ///< that it may have gone since, by changes of no more than T
    double far_way = 0;       ///< likewise by greater ones,
    double far_s = 0;         ///< of which the greater ones were given for so long
    bool far = false;         ///< the latest that was asked for is one
    double deceleration = 0;  ///< with which it may have stopped; 0: it stood
  };
  void note(Eigen::Index joint, const Vector& place, double net, double torque, double elapsed_s) noexcept;
  [[nodiscard]] double deceleration_most(Eigen::Index joint, const Vector& place) const noexcept;
  [[nodiscard]] Vector contact(const Vector& place) const noexcept;

  const Robot& robot_;
  device::RepeatedReadings repeats_;
  Vector far_;       ///< T
  Vector friction_;  ///< c
  Vector damping_;   ///< b
  Vector contact_;   ///< J'F at the latest reading
  std::array<Joint, control::kJointsMax> joints_{};
  std::optional<Nanoseconds> latched_{};
  bool frozen_ = false;
};

}  // namespace forcebound::server
