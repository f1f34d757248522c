#pragma once

#include <Eigen/Core>
#include <optional>

#include "forcebound/server/robot/robot.hpp"

namespace forcebound::server {

/// Bias of a force sensor: the mean of what it said while the robot waited for its first leader, touching nothing.
///
/// Real time: noexcept, no allocation.
class SensorBias {
 public:
  /// While the robot waits. A sample counts once.
  void learn(const std::optional<SensedForce>& sensed) noexcept {
    if (!sensed || sensed->sampled == last_) return;
    last_ = sensed->sampled;
    constexpr double kSamplesMost = 2000;
    count_ = count_ < kSamplesMost ? count_ + 1 : count_;
    bias_ += (wrench_of(*sensed) - bias_) / count_;
  }

  /// Force [N] above torque about the tool's point [N m].
  [[nodiscard]] std::optional<Vector6> without(const std::optional<SensedForce>& sensed) const noexcept {
    if (!sensed) return std::nullopt;
    return Vector6(wrench_of(*sensed) - bias_);
  }

 private:
  [[nodiscard]] static Vector6 wrench_of(const SensedForce& sensed) noexcept {
    Vector6 wrench;
    wrench << sensed.force_N, sensed.torque_N_m;
    return wrench;
  }

  Vector6 bias_{Vector6::Zero()};
  double count_ = 0;
  Nanoseconds last_{-1};
};

}  // namespace forcebound::server
