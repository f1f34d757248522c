#pragma once

#include <memory>
#include <string>
#include <variant>

#include "forcebound/device/kinematics/arm_kinematics.hpp"
#include "forcebound/device/kinematics/chain_kinematics.hpp"
#include "forcebound/device/kinematics/delta_kinematics.hpp"
#include "forcebound/device/kinematics/five_bar_kinematics.hpp"

namespace forcebound::device {

/// How a device's joints move its tip. The first: Cartesian, they are the axes of the tip.
using Geometry = std::variant<std::monostate, ArmGeometry, FiveBarGeometry, DeltaGeometry, ChainGeometry>;

/// @throws std::invalid_argument as ChainKinematics
[[nodiscard]] std::unique_ptr<const Kinematics> make_kinematics(const Geometry& geometry);

/// Why the scene's origin is no place to start from: out of reach, or singular, so that the tip cannot move every way
/// there. Empty: it is.
[[nodiscard]] std::string refusal_of_origin(const Kinematics& kinematics, int degrees_of_freedom);

/// "Cartesian", "serial arm", "five-bar linkage", "delta", "serial arm of 4 joints".
[[nodiscard]] std::string in_words(const Geometry& geometry);

}  // namespace forcebound::device
