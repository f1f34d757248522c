#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tests/tools/lab/marks.hpp"

namespace forcebound::lab {

inline constexpr Marks kAccuracyMarks{"<!-- accuracy: made by deploy/accuracy -->\n", "<!-- /accuracy -->\n"};

/// What a study found, as a table for a document: what each setting costs and how wrong it is behind each network, the
/// best in bold.
/// @param study as to_json gives it
/// @throws nlohmann::json::exception for anything else
std::string to_markdown(const nlohmann::ordered_json& study);

}  // namespace forcebound::lab
