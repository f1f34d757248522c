#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "forcebound/control/handle.hpp"
#include "forcebound/local_model/local_model.hpp"
#include "forcebound/server/follower/leader_motion.hpp"
#include "forcebound/server/robot/robot_model.hpp"

namespace forcebound::server {

/// How the leader's workspace is laid into the robot's.
struct WorkspaceSettings {
  double motion_scale = 1;  ///< m: the tool moves m times as far as the device; 0.01 to 100
  double force_scale = 1;   ///< k: the device shows k times the robot's force; 0.001 to 100
  /// R, a rotation: turns the leader's axes (x to the user's right, y away, z up) into the world's.
  Eigen::Matrix3d rotation{Eigen::AngleAxisd(-1.5707963267948966, Eigen::Vector3d::UnitZ()).toRotationMatrix()};
};

/// The place of the leader's tip in the robot's world, with an offset that a clutch changes:
///
///     x = x_0 + m R (p - p_0),   o = R o_l o_l0^-1 R' o_0         p_0, o_l0, x_0, o_0: as they were at `engage`
///     f_leader = k R' f_world,   K_leader = k m R' K_world R,   torque_leader = k/m R' torque_world
///
/// Powers differ by the scales: f_leader'p' = (k/m) f_world'x'. So energy that the leader gives counts m/k times at the
/// robot: `power_scale`. With m = k nothing is created or lost; else the two ports are passive together up to that
/// declared factor, as with any scaled teleoperation.
///
/// A leader of one or two axes moves the tool along the first of its axes only.
///
/// Real time: noexcept, no allocation.
class WorkspaceMap {
 public:
  /// @throws std::invalid_argument naming the setting, its value and what is accepted
  explicit WorkspaceMap(const WorkspaceSettings& settings);

  /// From now on the device here means the tool there: no jump.
  void engage(const LeaderMotion& leader, const ToolPose& tool) noexcept;

  [[nodiscard]] ToolPose tool_of(const LeaderMotion& leader) const noexcept;

  /// Where the leader's tip would be for this place of the tool's point [m].
  [[nodiscard]] local_model::Point leader_place_m(const Eigen::Vector3d& tool_point_m) const noexcept;

  /// Where the origin of the leader's frame is, and how its axes stand, in the robot's world; without the scale m.
  [[nodiscard]] Eigen::Isometry3d leader_frame() const noexcept;

  [[nodiscard]] Eigen::Vector3d to_leader_N(const Eigen::Vector3d& world_N) const noexcept {
    return settings_.force_scale * (settings_.rotation.transpose() * world_N);
  }
  [[nodiscard]] Eigen::Vector3d to_leader_direction(const Eigen::Vector3d& world) const noexcept {
    return settings_.rotation.transpose() * world;
  }
  /// Rotations are not scaled, so torques are by what keeps the scale of power that of the translations: k/m.
  [[nodiscard]] Eigen::Vector3d to_leader_N_m(const Eigen::Vector3d& world_N_m) const noexcept {
    return settings_.rotation.transpose() * world_N_m / power_scale();
  }
  /// Stiffness that the leader feels for one of the robot's world [N/m].
  [[nodiscard]] double leader_stiffness_N_per_m(double world_N_per_m) const noexcept {
    return settings_.force_scale * settings_.motion_scale * world_N_per_m;
  }
  [[nodiscard]] double power_scale() const noexcept { return settings_.motion_scale / settings_.force_scale; }
  [[nodiscard]] const WorkspaceSettings& settings() const noexcept { return settings_; }

 private:
  WorkspaceSettings settings_;
  Eigen::Vector3d leader_start_m_{Eigen::Vector3d::Zero()};
  std::optional<Eigen::Quaterniond> leader_orientation_;
  ToolPose tool_start_;
};

}  // namespace forcebound::server
