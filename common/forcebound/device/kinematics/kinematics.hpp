#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "forcebound/control/vector.hpp"

namespace forcebound::device {

using control::Matrix;
using control::Vector;

/// Of a tip that turns: axes in metres, before those in radians.
inline constexpr int kTranslations = 3;

/// Tip position from joint positions, in the scene frame: x to the user's right, y away from the user, z up [m]. There
/// may be more joints than axes of the tip, never fewer.
///
/// A mechanism of which this frame cannot be true at some joint positions (out of reach, or not to be assembled there)
/// still has finite numbers there: it has no stops, and the simulation of a device passes such places when a hand pulls
/// hard. Only a device's own audit, in its joints, is exact there.
///
/// Real time: noexcept, no allocation.
class Kinematics {
 public:
  virtual ~Kinematics() = default;

  /// Of the tip [m], a row for each of its translations. Finite everywhere.
  [[nodiscard]] virtual Vector position(const Vector& joint) const noexcept = 0;

  /// d position / d joint; where the tip turns, below it what gives its angular velocity in the scene's frame [rad/s].
  /// Finite everywhere, singular or not.
  [[nodiscard]] virtual Matrix jacobian(const Vector& joint) const noexcept = 0;

  /// Joints that bring the tip to `position`, or towards it as far as it can come; a tip that turns, as it is turned
  /// while all joints are at their start.
  [[nodiscard]] virtual Vector joints_at(const Vector& position) const noexcept = 0;

  /// Of the tip that turns: turns the handle's axes into the scene's. Of any other, none.
  [[nodiscard]] virtual std::optional<Eigen::Quaterniond> orientation(const Vector& joint) const noexcept {
    (void)joint;
    return std::nullopt;
  }

  /// As `joints_at` above; a tip that turns is turned so.
  [[nodiscard]] virtual Vector joints_at_pose(const Vector& position,
                                              const Eigen::Quaterniond& orientation) const noexcept {
    (void)orientation;
    return joints_at(position);
  }
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

}  // namespace forcebound::device
