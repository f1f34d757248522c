#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace forcebound::lab {

/// The data of comparison.gnuplot: stability against transparency, a row for each network and law that played through
/// it. Unbeaten is a law whose contacts rest, and which is passive, if no other such law has both less restlessness and
/// more stiffness. nan: of a law that never touched the wall, or never rested there.
/// @param standings as `standings` made them
[[nodiscard]] std::string comparison_csv(const nlohmann::ordered_json& standings);

/// The data of limits.gnuplot: the stiffest wall that comes to rest, a row for each hand, delay and law; and theory's,
/// named by their formulas. 0: not even the softest wall that was tried.
[[nodiscard]] std::string limits_csv(const nlohmann::ordered_json& standings);

}  // namespace forcebound::lab
