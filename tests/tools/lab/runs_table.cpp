#include "tests/tools/lab/runs_table.hpp"

#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

/// The number at a path like "/force_N/variance", scaled, or "-".
std::string number(const Json& summary, const char* path, double scale, int decimals) {
  const Json::json_pointer pointer(path);
  if (!summary.contains(pointer) || !summary.at(pointer).is_number()) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, summary.at(pointer).get<double>() * scale);
  // Avoids "-0".
  const bool zero = std::strpbrk(text, "123456789") == nullptr;
  return zero && text[0] == '-' ? text + 1 : text;
}

std::string line(const std::string& law, const std::string& passivity, const std::string& variance,
                 const std::string& stiffness, const std::string& age) {
  char text[256];
  std::snprintf(text, sizeof text, "%-12.12s %18s %15s %20s %11s\n", law.c_str(), passivity.c_str(), variance.c_str(),
                stiffness.c_str(), age.c_str());
  return text;
}

}  // namespace

std::string comparison_table(const std::vector<Json>& summaries) {
  std::string table = line("", "passivity minimum", "force variance", "displayed stiffness", "force age") +
                      line("law", "[mJ]", "[N^2]", "at rest [N/m]", "median [ms]");
  for (const Json& summary : summaries) {
    const bool named = summary.contains("law") && summary["law"].is_string();
    table +=
        line(named ? summary["law"].get<std::string>() : "-", number(summary, "/passivity/minimum_J", 1e3, 3),
             number(summary, "/force_N/variance", 1, 4), number(summary, "/displayed_stiffness_N_per_m/median", 1, 0),
             number(summary, "/force_age_ms/p50", 1, 1));
  }
  return table;
}

}  // namespace forcebound::lab
