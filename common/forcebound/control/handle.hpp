#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace forcebound::control {

/// What a device's handle tells beside the place of its tip. What a device does not have is absent.
struct Handle {
  /// Unit quaternion w, x, y, z: turns the handle's axes into the scene's.
  using Orientation = std::array<double, 4>;
  static constexpr int kButtons = 32;

  std::optional<std::uint32_t> buttons{};  ///< bit k: button k is pressed
  std::optional<double> gripper{};         ///< 0: closed, 1: open
  std::optional<Orientation> orientation{};

  /// A button that the device does not have is not pressed.
  [[nodiscard]] constexpr bool pressed(int button) const noexcept {
    return button >= 0 && button < kButtons && ((buttons.value_or(0) >> static_cast<unsigned>(button)) & 1U) != 0;
  }

  friend bool operator==(const Handle&, const Handle&) = default;
};

/// A handle of which all can be true, and how many fields of what was told could not.
struct SoundHandle {
  Handle handle{};
  int refused = 0;
};

/// Of a handle that a driver or client told: the orientation normalised if its length is within 1 % of one, the gripper
/// clamped if it is within 1 % of its range; else, as where a number is not finite, that field is absent. Real time.
[[nodiscard]] inline SoundHandle sound(const Handle& told) noexcept {
  constexpr double kOff = 0.01;
  SoundHandle sound{.handle = {.buttons = told.buttons}};
  if (told.gripper) {
    const bool holds = *told.gripper >= -kOff && *told.gripper <= 1 + kOff;  // false: not a number
    if (holds) sound.handle.gripper = std::clamp(*told.gripper, 0.0, 1.0);
    sound.refused += holds ? 0 : 1;
  }
  if (told.orientation) {
    const auto& [w, x, y, z] = *told.orientation;
    const double length = std::hypot(std::hypot(w, x), std::hypot(y, z));
    const bool holds = std::abs(length - 1) <= kOff;
    if (holds) sound.handle.orientation = {w / length, x / length, y / length, z / length};
    sound.refused += holds ? 0 : 1;
  }
  return sound;
}

}  // namespace forcebound::control
