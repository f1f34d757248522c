#pragma once

#include <optional>

#include "forcebound/control/rotation.hpp"
#include "forcebound/control/translation.hpp"
#include "forcebound/control/vector.hpp"

namespace forcebound::client {

/// Where the tool is on a tick.
struct ToolPoint {
  Eigen::Vector3d arm_m = Eigen::Vector3d::Zero();  ///< from the grip to the tip, in the scene's frame
  control::Vector tip{};                            ///< [m]; without a tool, the grip
  control::Vector place{};  ///< where the environment is asked: the tip, unless the law moves it
};

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
  void set_lever(const control::Vector& lever_m) noexcept {
    lever_m_ = control::translation_of(lever_m);
    in_hand_ = lever_m.rows() > 0;
  }

  [[nodiscard]] bool in_hand() const noexcept { return in_hand_; }

  /// @param grip_m of the device @param proxy_m the grip where the law wants the environment asked
  [[nodiscard]] ToolPoint at(const control::Vector& grip_m, const control::Vector& proxy_m,
                             const std::optional<control::Handle::Orientation>& orientation) const noexcept {
    const Eigen::Vector3d arm_m = arm(orientation);
    return {.arm_m = arm_m, .tip = grip_m + arm_m.head(grip_m.rows()), .place = proxy_m + arm_m.head(proxy_m.rows())};
  }

 private:
  [[nodiscard]] Eigen::Vector3d arm(const std::optional<control::Handle::Orientation>& orientation) const noexcept {
    if (!orientation || lever_m_.isZero(0)) return Eigen::Vector3d::Zero();
    return control::quaternion_of(*orientation) * lever_m_;
  }

  Eigen::Vector3d lever_m_ = Eigen::Vector3d::Zero();
  bool in_hand_ = false;
};

}  // namespace forcebound::client
