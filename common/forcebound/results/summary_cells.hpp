#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"

/// Cells of tables, out of the summaries that --summary writes.
namespace forcebound::results {

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

/// A line below a table of runs that says why there are dashes, where a hand never touched anything; else empty.
[[nodiscard]] inline std::string untouched_in_words(std::size_t untouched, std::size_t runs) {
  if (untouched == 0) return {};
  const std::string which = untouched == runs ? "" : " in " + std::to_string(untouched) + " of " + std::to_string(runs);
  return "\n  -           the hand never touched the scene" + which + ": nothing was felt that could be measured\n";
}
[[nodiscard]] inline bool never_touched(const nlohmann::ordered_json& summary) {
  return number_at(summary, "/contact_ticks") == 0;
}

/// A network in a heading, where "none" would not say of what.
[[nodiscard]] inline std::string network_in_words(const std::string& network) {
  return network == "none" ? "no network" : network;
}

/// A least P in the tables' unit, mJ: 0 where it is within rounding of it, "-" where it is not known.
[[nodiscard]] inline std::string millijoules(double least_P_J) {
  constexpr double kRounding_J = 1e-9;
  if (std::isnan(least_P_J)) return "-";
  return least_P_J >= -kRounding_J ? "0" : text::rounded(1e3 * least_P_J);
}

/// A stiffness in the tables' unit, N/mm, or "-" where it is not known.
[[nodiscard]] inline std::string newtons_per_mm(double stiffness_N_per_m) {
  return std::isfinite(stiffness_N_per_m) ? text::rounded(stiffness_N_per_m * 1e-3) : "-";
}

/// A run's least P [mJ], in red where that makes it not passive.
[[nodiscard]] inline text::Table::Cell least_P_cell(const nlohmann::ordered_json& summary) {
  const double least_P_J = number_at(summary, "/passivity/minimum_J");
  const bool alarm = summary.contains("verdict") && summary.at("verdict") == "not passive";
  return {millijoules(least_P_J), alarm ? text::Table::Mark::alarm : text::Table::Mark::none};
}

/// "remote" or "local"; "-" of summaries that are older than the choice.
[[nodiscard]] inline std::string rendering_of(const nlohmann::ordered_json& summary) {
  const nlohmann::ordered_json::json_pointer asked("/rendering/asked");
  return summary.contains(asked) && summary.at(asked).is_string() ? summary.at(asked).get<std::string>() : "-";
}

[[nodiscard]] inline std::string law_of(const nlohmann::ordered_json& summary) {
  return summary.contains("law") && summary["law"].is_string() ? summary["law"].get<std::string>() : "-";
}

}  // namespace forcebound::results
