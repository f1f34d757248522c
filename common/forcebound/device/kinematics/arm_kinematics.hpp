#pragma once

#include "forcebound/device/kinematics/kinematics.hpp"

namespace forcebound::device {

/// The size of a serial arm and where it stands [m].
struct ArmGeometry {
  double upper_length_m = 0;
  double fore_length_m = 0;
  double origin_reach_m = 0;   ///< distance of the scene's origin in front of the shoulder
  double origin_height_m = 0;  ///< height of the scene's origin above the shoulder
};

/// Base yaw, shoulder and elbow, the elbow driven through a parallelogram so that its angle is absolute.
///
/// joint = (yaw, shoulder, elbow) [rad]. With the links L1, L2
///
///     reach  r = L1 cos(shoulder) + L2 sin(elbow)
///     x = r sin(yaw),  y = origin reach - r cos(yaw),  z = L1 sin(shoulder) - L2 cos(elbow) - origin height
///
/// as in M. C. Cavusoglu, D. Feygin, F. Tendick, "A critical study of the mechanical and electrical properties of the
/// PHANToM haptic interface", Presence 11(6), 2002. The Jacobian is singular where the links line up (elbow - shoulder
/// = +-90 degrees) and where r = 0.
class ArmKinematics final : public Kinematics {
 public:
  explicit ArmKinematics(const ArmGeometry& geometry) : geometry_(geometry) {}

  [[nodiscard]] Vector position(const Vector& joint) const noexcept override;
  [[nodiscard]] Matrix jacobian(const Vector& joint) const noexcept override;
  [[nodiscard]] Vector joints_at(const Vector& position) const noexcept override;

 private:
  ArmGeometry geometry_;
};

}  // namespace forcebound::device
