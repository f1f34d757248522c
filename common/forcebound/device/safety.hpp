#pragma once

#include <optional>

#include "forcebound/control/device_facts.hpp"

namespace forcebound::device {

/// Limits for a person's hand and the motors, beside what passivity needs. They bound the force that is asked of the
/// law, so that what the law promises holds whatever they do. 0: there is no such limit.
struct Safety {
  double ramp_s = 0;               ///< the force grows in so long: after start, 20 ms without readings, a trip
  double speed_m_per_s_max = 0;    ///< a tip that is faster feels nothing until it is half as fast
  double turn_rad_per_s_max = 0;   ///< likewise a handle that turns faster, where the device shows a torque
  double workspace_radius_m = 0;   ///< beyond this distance from the origin the force fades to zero
  double workspace_fade_m = 0.01;  ///< over this one
  double rms_force_N_max = 0;      ///< root mean square of the force over about `rms_s`: more heats the motors
  double rms_torque_N_m_max = 0;   ///< likewise of the torque, where the device shows one
  double rms_s = 10;
  std::optional<int> dead_man_button{};  ///< the hand feels nothing unless this button is pressed; none: as always

  /// For a device that is not simulated, unless its file says otherwise.
  [[nodiscard]] static Safety of_a_person(const control::DeviceFacts& facts) noexcept {
    return {.ramp_s = 0.5,
            .speed_m_per_s_max = 2,
            .turn_rad_per_s_max = facts.torque_N_m_max > 0 ? 20.0 : 0.0,
            .rms_force_N_max = 0.6 * facts.force_N_max,
            .rms_torque_N_m_max = 0.6 * facts.torque_N_m_max};
  }

  friend bool operator==(const Safety&, const Safety&) = default;
};

}  // namespace forcebound::device
