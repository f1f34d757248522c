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
    bias_N_ += (sensed->force_N - bias_N_) / count_;
  }

  [[nodiscard]] std::optional<Eigen::Vector3d> without(const std::optional<SensedForce>& sensed) const noexcept {
    if (!sensed) return std::nullopt;
    return Eigen::Vector3d(sensed->force_N - bias_N_);
  }

 private:
  Eigen::Vector3d bias_N_{Eigen::Vector3d::Zero()};
  double count_ = 0;
  Nanoseconds last_{-1};
};

}  // namespace forcebound::server
