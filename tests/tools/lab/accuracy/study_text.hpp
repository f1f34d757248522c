#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tests/tools/lab/accuracy/study.hpp"

namespace forcebound::lab {

/// A table: cost of each setting, its error at the same states, and at the device behind each network, with its parts.
/// Errors within three times the reference's uncertainty is shown as "<=".
std::string to_text(const StudyResult& result);

/// Where a scene's key is negligible beside the age of forces: behind which networks the model's part of every setting
/// that worked, by itself, is below 10 % of the age's. One line; empty: nowhere.
std::string what_does_not_matter(const StudyResult& result);

nlohmann::ordered_json to_json(const StudyResult& result);

}  // namespace forcebound::lab
