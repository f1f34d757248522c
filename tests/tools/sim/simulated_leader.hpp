#pragma once

#include <cstdint>
#include <memory>
#include <random>

#include "forcebound/control/force_bounded_leader.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"

namespace forcebound::sim {

using time::Nanoseconds;

/// A leader arm and the hand on it in virtual time: SimulatedDevice in joint space, which dissipates as little as the
/// facts allow. What they leave open is drawn, mostly at the ends: when readings are latched and torques act, and each
/// servo's gain. Encoders are behind the play: what they read stays where it is until the motor reaches its stop.
/// Ripple is along with the motion. Inertia is constant; the hand holds each joint as it would hold an axis.
///
/// For joints that take torques; one that takes goals is told the torque. Not for real time.
class SimulatedLeader {
 public:
  /// @param inertia_kg_m2 of each joint
  /// @throws std::invalid_argument for more than 6 joints, another number of them, or what SimulatedDevice refuses
  SimulatedLeader(const control::LeaderFacts& facts, const control::Vector& inertia_kg_m2,
                  std::unique_ptr<const device::Operator> hand, std::uint64_t seed = 1);

  /// The encoders, latched within `read_s_max` of that stamp [rad]. Time must not run backwards.
  control::Vector read(Nanoseconds stamp);

  /// Commands torques [N m] on the newest reading; they act within `latency_s_max` of its stamp, if this is called
  /// before any time passes.
  void write(Nanoseconds now, const control::Vector& torque_N_m) { device_.apply(now, torque_N_m); }

  [[nodiscard]] control::PassivityAudit audit() const noexcept { return *device_.audit(); }
  [[nodiscard]] device::SimulatedDevice::Truth truth() const noexcept { return device_.truth(); }

 private:
  control::LeaderFacts facts_;
  device::SimulatedDevice device_;
  std::mt19937_64 random_;
  control::Vector behind_play_;  ///< where the encoders are
};

}  // namespace forcebound::sim
