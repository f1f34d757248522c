#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace forcebound::lab {

/// Runs side by side, a line each: law, passivity minimum, force variance, displayed stiffness and age of
/// the force. Where the passivity minimum is below zero, the device gave energy to the hand.
///
/// @param summaries as `--summary` wrote them; a number that is null or absent is shown as "-".
std::string comparison_table(const std::vector<nlohmann::ordered_json>& summaries);

}  // namespace forcebound::lab
