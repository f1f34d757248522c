#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace forcebound::lab {

/// A table of runs, a line each: law, passivity minimum, force variance, displayed stiffness and age of the force. A
/// passivity minimum below zero: not passive.
///
/// @param summaries as `--summary` wrote them; a number that is null or absent is shown as "-".
std::string comparison_table(const std::vector<nlohmann::ordered_json>& summaries);

}  // namespace forcebound::lab
