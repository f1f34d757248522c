#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace forcebound::results {

/// A run's file and what `--summary` writes of it.
struct NamedSummary {
  std::string file;
  nlohmann::ordered_json summary;
};

/// Reads what `--summary` wrote.
/// @throws std::runtime_error `FILE: ...` if it cannot be read or is none
[[nodiscard]] nlohmann::ordered_json read_summary(const std::string& file);

/// A table of runs, a line each: file, law, rendering, least P, force variance, displayed stiffness, age of the force
/// and trust in local models. A least P below zero: not passive. Files are named as briefly as tells them apart; a
/// number that is null or absent is shown as "-".
[[nodiscard]] std::string comparison_table(const std::vector<NamedSummary>& runs);

}  // namespace forcebound::results
