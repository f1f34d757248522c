#include "tests/tools/lab/runs_table.hpp"

#include "forcebound/text/table.hpp"
#include "tests/tools/lab/summary_cells.hpp"

namespace forcebound::lab {

std::string comparison_table(const std::vector<nlohmann::ordered_json>& summaries) {
  text::Table table({{"law"},
                     {"least P", "mJ"},
                     {"force variance", "N^2"},
                     {"displayed at rest", "N/m"},
                     {"median force age", "ms"}});
  for (const auto& summary : summaries) {
    table.add(
        {law_of(summary), cell_at(summary, "/passivity/minimum_J", 1e3, 3), cell_at(summary, "/force_N/variance", 1, 4),
         cell_at(summary, "/displayed_stiffness_N_per_m/median", 1, 0), cell_at(summary, "/force_age_ms/p50", 1, 1)});
  }
  return table.to_text();
}

}  // namespace forcebound::lab
