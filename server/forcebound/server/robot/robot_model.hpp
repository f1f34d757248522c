#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/scene/visible_part.hpp"

namespace forcebound::server {

using control::Matrix;
using control::Vector;

inline constexpr double kGravity_m_per_s2 = 9.81;

/// Where the tool's point is [m] and how the tool stands, in the robot's world frame: z is up, the base is at its
/// origin.
struct ToolPose {
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};
  Eigen::Quaterniond orientation{
      Eigen::Quaterniond::Identity()};  ///< unit length; turns the tool's axes into the world's
};

/// Velocity of the tool's point [m/s] above its angular velocity [rad/s], or force [N] above torque about the tool's
/// point [N m]; world frame.
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Vector6 per joint speed: 6 rows, a column for each joint.
using ToolJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, control::kJointsMax>;

/// What a robot may do; vectors have a row for each joint, [rad] or [m].
struct RobotLimits {
  Vector lowest;             ///< of the joints' positions
  Vector highest;            ///< likewise
  Vector speed_max;          ///< of the joints, > 0
  Vector torque_max;         ///< commanded beyond gravity, > 0 [N m] or [N]
  Vector torque_rate_max{};  ///< fastest change of a torque that is asked for [N m/s]; 0, or no rows: at once
  double tool_speed_m_per_s_max = 0;
  double tool_turn_rad_per_s_max = 0;
};

/// Where the links are, a frame for each joint, world frame.
using LinkFrames = std::array<Eigen::Isometry3d, control::kJointsMax>;

/// A part of a robot as a picture shows it; nothing touches it.
struct LinkShape {
  scene::VisiblePart part;  ///< a solid in its own frame
  int link = -1;            ///< that it is fixed to; -1: the base
  Eigen::Isometry3d in_link{Eigen::Isometry3d::Identity()};
  Eigen::Vector3d opens_m{Eigen::Vector3d::Zero()};  ///< moves it in the link's frame where the gripper is open
};

/// A robot's geometry and masses: pure functions of the joints' positions q, which have `joints()` rows.
///
/// Real time: all members are noexcept and allocate nothing. Any thread may call them at any time.
class RobotModel {
 public:
  virtual ~RobotModel() = default;

  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  [[nodiscard]] virtual int joints() const noexcept = 0;

  [[nodiscard]] virtual ToolPose pose(const Vector& q) const noexcept = 0;

  /// J(q): tool velocity = J q'.
  [[nodiscard]] virtual ToolJacobian jacobian(const Vector& q) const noexcept = 0;

  /// M(q), symmetric positive definite: kinetic energy = q'' M q' / 2 [kg m^2] or [kg].
  [[nodiscard]] virtual Matrix mass_matrix(const Vector& q) const noexcept = 0;

  [[nodiscard]] virtual const RobotLimits& limits() const noexcept = 0;

  /// A posture well inside the limits and far from singular ones: what redundant joints return to.
  [[nodiscard]] virtual const Vector& rest() const noexcept = 0;

  /// How it looks; none: nobody knows.
  [[nodiscard]] virtual const std::vector<LinkShape>& shapes() const noexcept {
    static const std::vector<LinkShape> kNone;
    return kNone;
  }

  /// Of the links that `shapes` name; the first `joints()` are of meaning.
  [[nodiscard]] virtual LinkFrames link_frames(const Vector& q) const noexcept {
    (void)q;
    LinkFrames frames;
    frames.fill(Eigen::Isometry3d::Identity());
    return frames;
  }
};

}  // namespace forcebound::server
