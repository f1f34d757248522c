#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace forcebound::lab {

/// Stability against transparency, a panel for each of up to three networks: a point for each law, a ring around those
/// that no other beats, a cross for those whose contacts mostly do not come to rest or that are not passive.
void draw_comparison(const nlohmann::ordered_json& standings, const std::filesystem::path& png);

/// The stiffest wall that comes to rest over the delay, a panel for each hand and a curve for each law, beside
/// theory's.
void draw_limits(const nlohmann::ordered_json& standings, const std::filesystem::path& png);

}  // namespace forcebound::lab
