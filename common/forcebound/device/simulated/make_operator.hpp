#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/device/simulated/operator.hpp"

namespace forcebound::device {

/// A simulated hand from its specification, `NAME[:KEY=VALUE,...]` or `replay:FILE.csv[,KEY=VALUE...]`:
/// press, stroke, trace-circle, trace-sphere, carry, wave, pointer, replay. Each knows mass_kg, stiffness_N_per_m and
/// damping_N_s_per_m of the hand, and button, button_from_s and button_until_s: a button that it presses (to the end,
/// unless told). Without these the handle has no buttons; carry presses its button by itself.
///
/// @param dof translations of the device that it moves, 1 to 6.
/// @param tip_turns the hand also turns the tip, by turn_x_rad, turn_y_rad, turn_z_rad and turn_Hz, and holds it by
/// inertia_kg_m2, rotation_stiffness_N_m_per_rad and rotation_damping_N_m_s_per_rad
/// @throws std::invalid_argument with what was wrong and what would be accepted; for a recorded motion `FILE:LINE:
/// ...`.
[[nodiscard]] std::unique_ptr<const Operator> make_operator(const std::string& specification, int dof,
                                                            bool tip_turns = false);

/// For a device with these facts: of as many translations, and turning its tip where that turns.
[[nodiscard]] std::unique_ptr<const Operator> make_operator(const std::string& specification,
                                                            const control::DeviceFacts& facts);

/// The file of a recorded hand, `replay:FILE.csv[,KEY=VALUE...]`; empty for any other.
[[nodiscard]] std::string recorded_hand(std::string_view specification);

/// Of a recorded hand, one line where its file is likely to have other units than seconds and metres; empty for any
/// other. @throws as make_operator.
[[nodiscard]] std::string doubt_of_hand(const std::string& specification, int dof);

/// Every operator with all its keys and their defaults, one on a line, for --help.
[[nodiscard]] std::string operators_help();

}  // namespace forcebound::device
