#pragma once

#include <string_view>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/device/kinematics/geometry.hpp"

namespace forcebound::device {

/// The table of a device's file that is named after its kind, "arm", "five_bar", "delta" or "chain".
/// @param degrees_of_freedom of the tip
/// @throws config::ConfigError with the line, also where a tip of five_bar, delta or chain does not reach the scene's
/// origin, or does not move every way there
[[nodiscard]] Geometry read_geometry(config::CheckedTable& file, std::string_view kind, int degrees_of_freedom);

}  // namespace forcebound::device
