#include "tests/lab/comparison.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

/// The number at a path like "/force_N/variance", scaled, or "-".
std::string number(const Json& summary, const char* path, double scale, const char* format) {
  const Json::json_pointer pointer(path);
  if (!summary.contains(pointer) || !summary.at(pointer).is_number()) return "-";
  char text[64];
  std::snprintf(text, sizeof text, format, summary.at(pointer).get<double>() * scale);
  return text;
}

std::string verdict(const Json& summary) {
  const Json::json_pointer pointer("/passivity/ok");
  if (!summary.contains(pointer) || !summary.at(pointer).is_boolean()) return "unknown";
  return summary.at(pointer).get<bool>() ? "yes" : "NO";
}

std::string line(const std::string& law, const std::string& passive, const std::string& least_P,
                 const std::string& variance, const std::string& stiffness, const std::string& age) {
  char text[256];
  std::snprintf(text, sizeof text, "%-12.12s %-9s %14s %16s %21s %20s\n", law.c_str(), passive.c_str(), least_P.c_str(),
                variance.c_str(), stiffness.c_str(), age.c_str());
  return text;
}

}  // namespace

std::string comparison_table(const std::vector<Json>& summaries) {
  std::string table = line("", "", "least P", "force variance", "displayed stiffness", "force age") +
                      line("law", "passive", "[mJ]", "[N^2]", "mean, median [N/m]", "median, p99 [ms]");
  for (const Json& summary : summaries) {
    const bool named = summary.contains("law") && summary["law"].is_string();
    table +=
        line(named ? summary["law"].get<std::string>() : "-", verdict(summary),
             number(summary, "/passivity/minimum_J", 1e3, "%.3f"), number(summary, "/force_N/variance", 1, "%.4f"),
             number(summary, "/displayed_stiffness_N_per_m/mean", 1, "%.0f") + ", " +
                 number(summary, "/displayed_stiffness_N_per_m/median", 1, "%.0f"),
             number(summary, "/force_age_ms/p50", 1, "%.1f") + ", " + number(summary, "/force_age_ms/p99", 1, "%.1f"));
  }
  return table;
}

}  // namespace forcebound::lab
