#pragma once

#include <array>
#include <cstddef>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/device/repeated_readings.hpp"

namespace forcebound::client {

using control::Vector;

/// Bounds the energy that a device gives to a hand while its readings repeat themselves, and finds out that they are
/// frozen.
///
/// A law takes a reading for where the device is. Where a driver repeats an old one, with a fresh stamp, the force
/// stays what it was there and a hand that leaves is pushed all its way. Nothing tells such a reading from that of a
/// hand which rests. So it is believed for as long as the hand can have got little meanwhile. Of a joint whose reading
/// has been the same to the last bit for a time t,
///
///     energy = integral of (|tau| - c)+ (v + a t)+ dt
///
/// with its torque tau = (J'f), its friction bound c, its speed v along that torque when the reading last changed
/// (RepeatedReadings), and a hand that leaves with a = 5 m/s^2 at the tip, or 0.1 m off it where a joint only turns the
/// handle. Of the sum over all joints, from 30 % of 50 mJ on the force fades, and at 80 % there is none. A
/// fading force is an answer asked for: a hand that rests follows it by a step of the encoder, and that brings the
/// force back within 50 ms.
///
/// What does not answer for 0.2 s, though it felt a force from nothing to all and back, is *frozen*, if the force was
/// greater than what friction and hand can hide: a quarter of the device's largest, or four times its friction bound,
/// and what moves the stiffest hand (5000 N/m) by two steps; or if it cannot have stopped as it did, with 200 m/s^2.
/// Then there is no force until the reading changes. What is held fast by something else, at a stop or in a vice,
/// counts too.
///
/// Real time: noexcept, no allocation, O(joints). Deterministic.
class UnseenEnergy {
 public:
  static constexpr double kMost_J = 0.05;

  /// @param limits none at all: nobody feels the device, and there is no bound
  UnseenEnergy(const control::DeviceFacts& facts, const device::Safety& limits) noexcept;

  /// @param reading usable @param applied since the reading before: the force, and the torque below it
  void add(const device::Reading& reading, const Vector& applied, double elapsed_s) noexcept;

  /// Of what is wanted, the share that may be asked for.
  [[nodiscard]] double share() const noexcept { return share_; }
  [[nodiscard]] bool frozen() const noexcept { return frozen_; }

 private:
  struct Joint {
    double energy_J = 0;
    double most_N = 0;  ///< of the force along its way, beyond friction
  };
  void add(Eigen::Index joint, double torque, double reach_m, double elapsed_s) noexcept;
  [[nodiscard]] bool is_frozen(Eigen::Index joint, double reach_m) const noexcept;

  bool bounds_;
  double force_N_max_;
  Vector friction_;
  Vector step_;
  device::RepeatedReadings repeats_;
  std::array<Joint, control::kJointsMax> joints_{};
  double share_ = 1;
  bool frozen_ = false;
};

}  // namespace forcebound::client
