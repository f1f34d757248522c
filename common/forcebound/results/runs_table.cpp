#include "forcebound/results/runs_table.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/table.hpp"

namespace forcebound::results {
namespace {

/// The last parts of each path, as many as it takes for all to differ; of paths that are equal, all parts.
std::vector<std::string> short_names(const std::vector<NamedSummary>& runs) {
  const auto last_parts = [](const std::filesystem::path& path, std::ptrdiff_t count) {
    std::filesystem::path name;
    for (auto part = std::prev(path.end(), std::min(count, std::distance(path.begin(), path.end())));
         part != path.end(); ++part) {
      name /= *part;
    }
    return name.string();
  };
  std::vector<std::string> names;
  for (const NamedSummary& run : runs) {
    const std::filesystem::path path(run.file);
    const auto parts = std::distance(path.begin(), path.end());
    const auto ambiguous = [&](std::ptrdiff_t count) {
      const std::string name = last_parts(path, count);
      return std::ranges::any_of(runs, [&](const NamedSummary& other) {
        return other.file != run.file && last_parts(other.file, count) == name;
      });
    };
    std::ptrdiff_t count = 1;
    while (count < parts && ambiguous(count)) ++count;
    names.push_back(last_parts(path, count));
  }
  return names;
}

}  // namespace

nlohmann::ordered_json read_summary(const std::string& file) {
  auto summary = nlohmann::ordered_json::parse(text::read_file(file), nullptr, false);
  if (!summary.is_object() || !summary.contains("law") || !summary.contains("verdict")) {
    throw std::runtime_error(file + ": not a summary; expected the output of a client's --summary");
  }
  return summary;
}

std::string comparison_table(const std::vector<NamedSummary>& runs) {
  text::Table table({{"run"},
                     {"law", "", text::Table::Align::left},
                     {"rendering", "", text::Table::Align::left},
                     {"least P", "mJ"},
                     {"variance", "N^2"},
                     {"displayed", "N/m"},
                     {"force age", "ms"},
                     {"trust", "%"}});
  const std::vector<std::string> names = short_names(runs);
  std::size_t untouched = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto& summary = runs[i].summary;
    untouched += never_touched(summary) ? 1 : 0;
    table.add({names[i], law_of(summary), rendering_of(summary), least_P_cell(summary),
               cell_at(summary, "/force_N/variance", 1, 4),
               cell_at(summary, "/displayed_stiffness_N_per_m/median", 1, 0),
               cell_at(summary, "/force_age_ms/p50", 1, 1), cell_at(summary, "/rendering/model_trust", 100, 0)});
  }
  return table.to_text() + untouched_in_words(untouched, runs.size()) +
         "\n  Variance of the force in contact; displayed stiffness at rest and force age\n"
         "  are medians; trust in local models is a mean, \"-\" where there were none.\n";
}

}  // namespace forcebound::results
