#pragma once

#include "forcebound/control/vector.hpp"

namespace forcebound::device {

using control::Matrix;
using control::Vector;

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

  /// Of the tip [m], a row for each of its axes. Finite everywhere.
  [[nodiscard]] virtual Vector position(const Vector& joint) const noexcept = 0;

  /// d position / d joint. Finite everywhere, singular or not.
  [[nodiscard]] virtual Matrix jacobian(const Vector& joint) const noexcept = 0;

  /// Joints that bring the tip to `position`, or towards it as far as it can come.
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

}  // namespace forcebound::device
