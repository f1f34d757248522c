#pragma once

#include <Eigen/Core>

#include "forcebound/server/robot/impedance_controller.hpp"

namespace forcebound::server {

/// Brings the tool's target towards where the leader wants it: smoothed, so that motions that come in bursts do not
/// shake the robot, and never faster than the limits.
///
/// Real time: noexcept, no allocation.
class TargetLimiter {
 public:
  TargetLimiter(double speed_m_per_s_max, double turn_rad_per_s_max) noexcept
      : speed_most_(speed_m_per_s_max), turn_most_(turn_rad_per_s_max) {}

  /// Here and at rest.
  void restart(const ToolPose& pose) noexcept { target_ = {.pose = pose}; }

  const ToolTarget& move_to(const ToolPose& wanted, double elapsed_s) noexcept;
  const ToolTarget& rest() noexcept {
    target_.velocity.setZero();
    target_.turn.setZero();
    return target_;
  }

  [[nodiscard]] const ToolTarget& target() const noexcept { return target_; }

 private:
  double speed_most_;
  double turn_most_;
  ToolTarget target_;
};

}  // namespace forcebound::server
