#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/server/robot/impedance_controller.hpp"
#include "forcebound/server/robot/robot.hpp"

namespace forcebound::server {

/// A plane that the device can render itself, world frame.
struct ReflectedPlane {
  std::uint32_t id = 0;
  Eigen::Vector3d place_m{Eigen::Vector3d::Zero()};
  Eigen::Vector3d normal{Eigen::Vector3d::UnitZ()};  ///< unit, out of it
  double stiffness_N_per_m = 0;
  double friction = 0;  ///< coefficient, >= 0
};

/// What the device shall show, as the robot knows it on a tick; world frame, forces on the hand.
///
///     f(x_wanted) = force_N - K (x_wanted - tool_m) + K_p n max(0, n.(p - x_wanted)) + tow
///     torque(o_wanted) = torque_N_m + K_r rotation vector from o_wanted to the tool's orientation
///
/// Of the plane's friction nothing is in it: the device's end renders that, at its own rate.
///
/// Each part is cut to `force_N_max` or `torque_N_m_max`; beyond a lag of 2 rad the torque of K_r fades, to nothing at
/// half a turn, where it would change its side. Tow: where the robot's law is short of energy the robot lags; the hand
/// then feels a spring to it, beyond some slack, so that the energy that the robot needs comes from the hand.
struct Reflection {
  Eigen::Vector3d force_N{Eigen::Vector3d::Zero()};
  double tie_N_per_m = 0;  ///< K
  Eigen::Vector3d tool_m{Eigen::Vector3d::Zero()};
  std::optional<ReflectedPlane> plane{};
  double tow_N_per_m = 0;  ///< to the same place
  double tow_slack_m = 0;
  double force_N_max = 0;
  Eigen::Vector3d torque_N_m{Eigen::Vector3d::Zero()};
  double turn_N_m_per_rad = 0;  ///< K_r
  Eigen::Quaterniond tool_orientation{Eigen::Quaterniond::Identity()};
  double torque_N_m_max = 0;  ///< 0: no torque is shown

  /// On a hand that wants the tool's orientation so [N m].
  [[nodiscard]] Eigen::Vector3d torque_at(const Eigen::Quaterniond& wanted) const noexcept;

  /// @param wanted_m where the leader wants the tool
  [[nodiscard]] Eigen::Vector3d at(const Eigen::Vector3d& wanted_m) const noexcept;
};

/// Which signals go which way between a leader and a robot: from the device's place to what the robot shall do, and
/// from what the robot does to what the device shall show. One per robot.
///
/// Both ends bound what an architecture asks for: the law at the device its force, the law at the robot its torques. So
/// none of them can cost passivity, only accuracy.
///
/// Real time: noexcept, no allocation.
class Architecture {
 public:
  virtual ~Architecture() = default;

  /// What is known of the robot on a tick.
  struct Sample {
    Nanoseconds now{0};
    double elapsed_s = 0;      ///< since the tick before
    const ToolTarget& target;  ///< where the leader wants the tool, already limited in speed
    const ToolPose& tool;      ///< where it is
    const Vector6& velocity;
    /// Of the tool on its surroundings, less the bias: force [N] above torque about the tool's point [N m]; none: there
    /// is no sensor.
    std::optional<Vector6> sensed;
  };

  /// What the robot's impedance controller shall do. Once a tick while the robot follows.
  [[nodiscard]] virtual ToolTarget ask(const Sample& sample) noexcept = 0;

  /// As of the latest `ask`.
  [[nodiscard]] virtual Reflection reflection() const noexcept = 0;

  /// The robot begins to follow, with another offset.
  virtual void begin() noexcept {}
};

/// An architecture that can be asked for by name.
struct ArchitectureKind {
  std::string_view name;
  std::string_view summary;
  bool needs_sensor = false;
  double initial_share = 1;  ///< of the largest E_0: with that its robot begins, unless told otherwise
  ImpedanceSettings impedance{};
  std::function<std::unique_ptr<Architecture>(const ImpedanceSettings&)> make{};
};

/// Of a reflection: none of a robot that cannot turn its tool as the hand wants it.
[[nodiscard]] inline double largest_torque_N_m(const ImpedanceSettings& impedance) noexcept {
  return impedance.stiffness_N_m_per_rad > 0 ? impedance.torque_N_m_max : 0;
}

/// All of them.
[[nodiscard]] const std::vector<ArchitectureKind>& architectures();

/// @throws std::invalid_argument naming the known ones
[[nodiscard]] const ArchitectureKind& find_architecture(std::string_view name);

[[nodiscard]] ArchitectureKind position_position();
[[nodiscard]] ArchitectureKind position_force();
[[nodiscard]] ArchitectureKind position_force_damped();
[[nodiscard]] ArchitectureKind model_mediated();

}  // namespace forcebound::server
