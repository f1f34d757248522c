#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "forcebound/text/marks.hpp"

namespace forcebound::lab {

inline constexpr text::Marks kAccuracyMarks{"<!-- accuracy: made by deploy/accuracy -->\n", "<!-- /accuracy -->\n"};

/// Of those that worked, and of a session's settings stayed passive, the one with the least error behind a network; the
/// number of settings if none did.
[[nodiscard]] std::size_t best_behind(const nlohmann::ordered_json& study, std::size_t network);

/// The results of a study as a table for a document: cost of each setting and its error behind each network, the best
/// in bold.
/// @param study as made by to_json
/// @throws nlohmann::json::exception for anything else
std::string to_markdown(const nlohmann::ordered_json& study);

}  // namespace forcebound::lab
