#pragma once

#include <nlohmann/json_fwd.hpp>

#include "forcebound/results/draw.hpp"

namespace forcebound::lab {

/// The error at the device behind each network for each setting, the least one marked, and the parts of the error
/// (accuracy.gnuplot).
/// @param study as `to_json` made it
[[nodiscard]] results::Figure study_figure(const nlohmann::ordered_json& study);

}  // namespace forcebound::lab
