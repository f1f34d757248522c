#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "forcebound/device/device_description.hpp"

namespace forcebound::device {

/// A device from the text of its TOML file; the device is named after the file. Real devices' facts and simulated
/// devices' motion in one place:
///
///     kind = "cartesian"              degrees_of_freedom (1 to 3), mass_kg, damping_N_s_per_m, friction_N = 0,
///                                     encoder_step_m = 0, actuator_step_N = 0
///     the others                      joint_inertia_kg_m2, joint_damping_N_m_s_per_rad, joint_friction_N_m = 0,
///                                     encoder_step_rad = 0, actuator_step_N_m = 0, and
///     kind = "arm"                    degrees_of_freedom = 3 (ArmKinematics), and
///                                     [arm] upper_length_m, fore_length_m, origin_reach_m, origin_height_m
///     kind = "five_bar"               degrees_of_freedom = 2 (FiveBarKinematics), and
///                                     [five_bar] base_distance_m, proximal_length_m, distal_length_m, origin_reach_m
///     kind = "delta"                  degrees_of_freedom = 3 (DeltaKinematics), and
///                                     [delta] base_radius_m, platform_radius_m, upper_arm_length_m, forearm_length_m,
///                                     side_offset_m = 0, first_arm_rad, origin_reach_m
///     kind = "chain"                  degrees_of_freedom, of the tip: x; x and y; x, y and z; or 6, these and the
///                                     rotations, with torque_N_m_max (ChainKinematics), and
///                                     [chain] tip_m = [x, y, z] at zero angles, and as many joints as those or more,
///                                     up to 6, from the base to the tip: [[chain.joint]] name, axis = [x, y, z],
///                                     point_m = [x, y, z] on the axis, start_rad = 0; more joints than degrees of
///                                     freedom take no actuator_step_N_m
///     all                             force_N_max, period_s = 0.001, hold_s_max = 0.002, release_share = 0,
///                                     release_s = 0, releases = true, latency_s = 0, and the speed that no joint ever
///                                     exceeds, speed_m_per_s_max or joint_speed_rad_per_s_max (none: any may be);
///                                     identified = true: false says that the bounds are guesses, which the client
///                                     tells of a real device; a simulated one has exactly these bounds
///     [uncertainty]                   how far the truth may be from these facts and from the stamps, all 0 unless said
///                                     (control::Uncertainty): pairs [least, most] of what another one may be each time
///                                     beyond what the facts say, stamp_s, latency_s, hold_s, and of what is one
///                                     constant over a run, latency_offset_s, torque_gain_share (one number: as much
///                                     less); shares clock_share, damping_share, friction_share, torque_ripple_share
///                                     (torque_share before); encoder_steps beyond half a step; actuator_lag_s;
///                                     losses_with_gain = false: true says that damping and friction are told in units
///                                     of the commands, so that each motor's gain times them is the truth
///
///     [safety]                        limits for the hand (Safety): ramp_s, speed_m_per_s_max, workspace_radius_m,
///                                     workspace_fade_m, rms_force_N_max, rms_s, and with torque_N_m_max
///                                     turn_rad_per_s_max and rms_torque_N_m_max; those of a simulated device are 0
///                                     unless said; dead_man_button, which no device has unless said
///
/// A number holds for all axes; a list has one for each; inertia and damping may also be full matrices (lists of rows).
///
/// @param place the file's name, for errors.
/// @throws std::runtime_error `PLACE:LINE: device 'NAME': KEY must be ..., got ...`; unknown keys are errors.
[[nodiscard]] DeviceDescription parse_device(std::string_view toml_text, const std::string& place);

/// A device that is not simulated, as far as its file says.
struct RealDevice {
  control::DeviceFacts facts;
  Safety safety;
  bool identified = true;  ///< false: the bounds are guesses
};

/// As above, only what a law may rely on, for a device that is not simulated: mass, inertia and geometry may be left
/// out, but for that of a chain, and an arm may have 1 to 6 joints.
[[nodiscard]] RealDevice parse_facts(std::string_view toml_text, const std::string& place);

/// Whether this is a file's path (has a '/' or ends with ".toml") rather than the name of a device.
[[nodiscard]] bool names_a_file(std::string_view name_or_file) noexcept;

/// A shipped device by its name, or any other by its file.
/// @throws std::invalid_argument listing the known devices if there is none of that name; std::runtime_error as
/// parse_device, or if there is no such file.
[[nodiscard]] DeviceDescription load_device(const std::string& name_or_file);

/// The names of the shipped devices.
[[nodiscard]] std::vector<std::string> shipped_device_names();

}  // namespace forcebound::device
