#pragma once

#include <Eigen/Core>
#include <optional>

#include "forcebound/client/ros2/state_queue.hpp"
#include "forcebound/time/tick_ring.hpp"

namespace forcebound::ros2 {

/// Of the tip, in the scene's axes.
struct Velocity {
  Eigen::Vector3d linear_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_rad_per_s = Eigen::Vector3d::Zero();
};

/// The mean velocity over the newest 5 ms of readings, since one between two ticks is mostly the encoders' steps; it is
/// 2.5 ms late for that.
class VelocityWindow {
 public:
  /// None: this is the first reading, or the first after one that was not finite.
  [[nodiscard]] std::optional<Velocity> update(const StateSample& sample) noexcept;

 private:
  static constexpr Nanoseconds kLong = std::chrono::milliseconds{5};

  time::TickRing<StateSample, 32> samples_{};
};

}  // namespace forcebound::ros2
