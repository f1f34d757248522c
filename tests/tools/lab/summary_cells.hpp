#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "forcebound/text/numbers.hpp"

/// Cells of tables, out of the summaries that --summary writes.
namespace forcebound::lab {

/// The number at a path like "/force_N/max", or not a number where it is null or absent.
[[nodiscard]] inline double number_at(const nlohmann::ordered_json& summary, const char* path) {
  const nlohmann::ordered_json::json_pointer pointer(path);
  return summary.contains(pointer) && summary.at(pointer).is_number() ? summary.at(pointer).get<double>()
                                                                      : std::nan("");
}

/// The same times `scale` with so many decimals, or "-".
[[nodiscard]] inline std::string cell_at(const nlohmann::ordered_json& summary, const char* path, double scale,
                                         int decimals) {
  return text::fixed(scale * number_at(summary, path), decimals);
}

[[nodiscard]] inline std::string law_of(const nlohmann::ordered_json& summary) {
  return summary.contains("law") && summary["law"].is_string() ? summary["law"].get<std::string>() : "-";
}

}  // namespace forcebound::lab
