#pragma once

#include <optional>

#include "forcebound/control/rotation.hpp"
#include "forcebound/control/translation.hpp"
#include "forcebound/control/vector.hpp"

namespace forcebound::client {

/// A rigid tool in the hand, which touches the scene with its tip: R turns the handle's axes into the scene's, x is the
/// grip, F the force at the tip.
///
///     r = R lever,   x_tip = x + r,   torque at the grip = r x F
///
/// so that the power is the same at both, F'(x' + w x r) = F'x' + (r x F)'w, and what is passive at the tip is at the
/// grip. Without an orientation nobody knows where the tip is, and the tool is none.
///
/// Real time: noexcept, no allocation.
class Tool {
 public:
  /// @param lever_m from the grip to the tip in the handle's axes [m]; three rows, or none: no tool
  void take(const control::Vector& lever_m) noexcept { lever_m_ = control::translation_of(lever_m); }

  /// r.
  [[nodiscard]] Eigen::Vector3d arm_m(const std::optional<control::Handle::Orientation>& orientation) const noexcept {
    if (!orientation || lever_m_.isZero(0)) return Eigen::Vector3d::Zero();
    return control::quaternion_of(*orientation) * lever_m_;
  }

 private:
  Eigen::Vector3d lever_m_ = Eigen::Vector3d::Zero();
};

/// The tip, in the rows of the grip.
[[nodiscard]] inline control::Vector tip_of(const control::Vector& grip_m, const Eigen::Vector3d& arm_m) noexcept {
  return grip_m + arm_m.head(grip_m.rows());
}

}  // namespace forcebound::client
