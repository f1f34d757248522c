#pragma once

#include "forcebound/server/robot/robot_model.hpp"

namespace forcebound::server {

/// Joints that bring the tool to a pose, and how far it is from there with them.
struct Posture {
  Vector joints;
  double off_m = 0;
  double off_rad = 0;

  /// To a tenth of an encoder's step, as far as anybody can tell.
  [[nodiscard]] bool reaches() const noexcept { return off_m < 1e-7 && off_rad < 1e-6; }
};

/// The posture nearest to the pose within the joints' limits, found from the rest posture by damped least squares, and
/// from others near it if that ends elsewhere. No real time.
[[nodiscard]] Posture posture_for(const RobotModel& model, const ToolPose& pose);

/// The shortest turn from one orientation to the other, as a rotation vector in the world frame [rad], at most pi long.
[[nodiscard]] Eigen::Vector3d turn_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) noexcept;

}  // namespace forcebound::server
