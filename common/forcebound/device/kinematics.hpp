#pragma once

#include "forcebound/control/vector.hpp"

namespace forcebound::device {

using control::Matrix;
using control::Vector;

/// Tip position from joint positions, in the scene frame. There are as many joints as task axes.
///
/// Real time: noexcept, no allocation.
class Kinematics {
 public:
  virtual ~Kinematics() = default;

  [[nodiscard]] virtual Vector position(const Vector& joint) const noexcept = 0;

  /// d position / d joint. Finite everywhere, singular or not.
  [[nodiscard]] virtual Matrix jacobian(const Vector& joint) const noexcept = 0;

  /// Joints that bring the tip to `position`, or as near as it can come.
  [[nodiscard]] virtual Vector joints_at(const Vector& position) const noexcept = 0;
};

/// Kinematics of a Cartesian device: its joints are the task axes.
class CartesianKinematics final : public Kinematics {
 public:
  [[nodiscard]] Vector position(const Vector& joint) const noexcept override { return joint; }
  [[nodiscard]] Matrix jacobian(const Vector& joint) const noexcept override {
    return Matrix::Identity(joint.size(), joint.size());
  }
  [[nodiscard]] Vector joints_at(const Vector& position) const noexcept override { return position; }
};

/// The size of a serial arm and where it stands [m].
struct ArmGeometry {
  double upper_length_m = 0;
  double fore_length_m = 0;
  double origin_reach_m = 0;   ///< distance of the scene's origin in front of the shoulder
  double origin_height_m = 0;  ///< height of the scene's origin above the shoulder
};

/// Base yaw, shoulder and elbow, the elbow driven through a parallelogram so that its angle is absolute.
///
/// Scene frame: x to the user's right, y away from the user towards the arm, z up; joint = (yaw, shoulder, elbow)
/// [rad]. With the links L1, L2
///
///     reach  r = L1 cos(shoulder) + L2 sin(elbow)
///     x = r sin(yaw),  y = origin reach - r cos(yaw),  z = L1 sin(shoulder) - L2 cos(elbow) - origin height
///
/// The Jacobian is singular where the links line up (elbow - shoulder = +-90 degrees) and where r = 0.
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
