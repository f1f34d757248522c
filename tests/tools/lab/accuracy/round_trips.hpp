#pragma once

#include <string>
#include <vector>

namespace forcebound::lab {

/// Round trips [s] from text, each "5ms", "0.02s", "500us" or bare milliseconds.
/// @throws std::invalid_argument naming the invalid one
[[nodiscard]] std::vector<double> parse_round_trips_s(const std::vector<std::string>& times);

}  // namespace forcebound::lab
