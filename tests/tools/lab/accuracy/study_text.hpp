#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tests/tools/lab/accuracy/study.hpp"

namespace forcebound::lab {

/// A table for people: what each setting costs, how wrong it is at the same states, and how wrong at the device behind
/// each network, with its parts. What lies within three times the reference's uncertainty is shown as "<=".
std::string to_text(const StudyResult& result);

/// Where a scene's key is lost beside the age of forces: behind which networks the model's part of every setting that
/// worked, by itself, is below 10 % of the age's. One line; empty: nowhere.
std::string what_does_not_matter(const StudyResult& result);

nlohmann::ordered_json to_json(const StudyResult& result);

/// The error at the device over the time a step takes, a curve for each round trip, its best point marked; and what the
/// error comes from behind the nearest and the farthest network.
void draw(const StudyResult& result, const std::string& title, const std::filesystem::path& png);

}  // namespace forcebound::lab
