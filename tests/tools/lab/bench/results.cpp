#include "tests/tools/lab/bench/results.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/trials/percentile.hpp"

namespace forcebound::lab {
namespace {

constexpr const char* kHeader = "kind,what,unit,conditions,ours,yardstick,theirs,ratio,spread,wanted";
constexpr std::size_t kColumns = 10;
/// A row of the table for a terminal takes more than the usual 80.
constexpr std::size_t kTableColumns = 100;

std::string number(double value) {
  if (!std::isfinite(value)) throw std::runtime_error("a result is not finite");
  return text::rounded(value);
}

std::string or_dash(const std::string& text) { return text.empty() ? "-" : text; }

std::string joined(const std::vector<std::pair<std::string, std::string>>& machine) {
  std::string text;
  for (const auto& [key, value] : machine) {
    if (!text.empty()) text += ", ";
    text.append(key).append(" ").append(value);
  }
  return text;
}

template <class Show>
void for_each(const BenchResults& results, BenchRow::Kind kind, Show show) {
  for (const BenchRow& row : results.rows) {
    if (row.kind == kind) show(row);
  }
}

/// Of a wanted "<= 1.25" the number.
std::string bound_of(const BenchRow& row) { return row.wanted.substr(row.wanted.find(' ') + 1); }

text::Table::Cell ratio_cell(const BenchRow& row) {
  return {or_dash(row.ratio), row.fine() ? text::Table::Mark::none : text::Table::Mark::alarm};
}

}  // namespace

bool BenchRow::fine() const {
  if (wanted.empty() || ratio.empty()) return true;
  const double bound = text::finite_number(bound_of(*this)).value_or(0);
  const double value = text::finite_number(ratio).value_or(0);
  return wanted.starts_with(">=") ? value >= bound : value <= bound;
}

BenchRow ratio_row(std::string what, std::string unit, double ours, std::string yardstick, double theirs,
                   std::string wanted) {
  return {.kind = BenchRow::Kind::ratio,
          .what = std::move(what),
          .unit = std::move(unit),
          .conditions = {},
          .ours = number(ours),
          .yardstick = std::move(yardstick),
          .theirs = number(theirs),
          .ratio = number(ours / theirs),
          .spread = {},
          .wanted = std::move(wanted)};
}

BenchRow turns_row(std::string what, std::string unit, std::string conditions, const std::vector<double>& ours,
                   std::string yardstick, const std::vector<double>& theirs, std::string wanted) {
  if (ours.empty() || ours.size() != theirs.size()) {
    throw std::runtime_error(what + ": " + std::to_string(ours.size()) + " runs of ours beside " +
                             std::to_string(theirs.size()) + " of " + yardstick);
  }
  BenchRow row = ratio_row(std::move(what), std::move(unit), percentile(ours, 0.5), std::move(yardstick),
                           percentile(theirs, 0.5), std::move(wanted));
  row.conditions = std::move(conditions);
  if (ours.size() == 1) return row;
  std::vector<double> ratios;
  std::transform(ours.begin(), ours.end(), theirs.begin(), std::back_inserter(ratios), std::divides<>());
  const auto [least, largest] = std::minmax_element(ratios.begin(), ratios.end());
  row.spread = number(*least) + " to " + number(*largest);
  return row;
}

BenchRow growth_row(std::string what, std::string size, double ours, std::string yardstick, double theirs) {
  const bool alone = yardstick.empty();
  const auto exponent = [](double value) { return text::fixed(value, 2); };
  return {.kind = BenchRow::Kind::growth,
          .what = std::move(what),
          .unit = std::move(size),
          .conditions = {},
          .ours = exponent(ours),
          .yardstick = std::move(yardstick),
          .theirs = alone ? std::string() : exponent(theirs),
          .ratio = {},
          .spread = {},
          .wanted = {}};
}

std::string to_csv(const BenchResults& results) {
  std::string csv;
  for (const auto& [key, value] : results.machine) csv.append("# ").append(key).append(": ").append(value).append("\n");
  csv += std::string(kHeader) + '\n';
  for (const BenchRow& row : results.rows) {
    csv += row.kind == BenchRow::Kind::ratio ? "ratio" : "growth";
    for (const std::string* cell : {&row.what, &row.unit, &row.conditions, &row.ours, &row.yardstick, &row.theirs,
                                    &row.ratio, &row.spread, &row.wanted}) {
      if (cell->find_first_of(",\n") != std::string::npos) {
        throw std::runtime_error("a cell must not have commas: '" + *cell + "'");
      }
      csv += ',' + *cell;
    }
    csv += '\n';
  }
  return csv;
}

BenchResults parse_bench_csv(std::string_view csv, const std::string& file) {
  BenchResults results;
  std::istringstream stream{std::string(csv)};
  text::LineReader lines(stream, file);
  bool headed = false;
  while (lines.next()) {
    const std::string line(lines.line());
    const std::size_t colon = line.find(": ");
    if (line.starts_with("# ") && colon != std::string::npos && !headed) {
      results.machine.emplace_back(line.substr(2, colon - 2), line.substr(colon + 2));
      continue;
    }
    if (!headed) {
      if (line != kHeader) lines.refuse("expected '" + std::string(kHeader) + "', got '" + line + "'");
      headed = true;
      continue;
    }
    const auto cells = text::split(line, ',');
    if (cells.size() != kColumns || (cells[0] != "ratio" && cells[0] != "growth")) {
      lines.refuse("not a result: '" + line + "'");
    }
    results.rows.push_back({.kind = cells[0] == "ratio" ? BenchRow::Kind::ratio : BenchRow::Kind::growth,
                            .what = std::string(cells[1]),
                            .unit = std::string(cells[2]),
                            .conditions = std::string(cells[3]),
                            .ours = std::string(cells[4]),
                            .yardstick = std::string(cells[5]),
                            .theirs = std::string(cells[6]),
                            .ratio = std::string(cells[7]),
                            .spread = std::string(cells[8]),
                            .wanted = std::string(cells[9])});
  }
  if (!headed) lines.refuse("no results; expected what --csv wrote");
  return results;
}

std::string ratios_csv(const BenchResults& results) {
  text::Table table({{"what"}, {"yardstick"}, {"conditions"}, {"ratio"}, {"bound"}, {"missed"}});
  for_each(results, BenchRow::Kind::ratio, [&](const BenchRow& row) {
    table.add({row.what, row.yardstick, or_dash(row.conditions), row.ratio, row.wanted.empty() ? "0" : bound_of(row),
               row.fine() ? "0" : "1"});
  });
  return table.to_csv();
}

std::string to_table(const BenchResults& results, text::Colour colour) {
  using Align = text::Table::Align;
  text::Table ratios(
      {{"median"}, {"ours"}, {"beside", "", Align::left}, {"theirs"}, {"ratio"}, {"wanted", "", Align::left}});
  std::string conditions;
  for_each(results, BenchRow::Kind::ratio, [&](const BenchRow& row) {
    if (row.conditions != conditions) {
      conditions = row.conditions;
      ratios.add_heading(conditions.empty() ? "single functions" : conditions);
    }
    ratios.add({row.what, row.ours, or_dash(row.yardstick), or_dash(row.theirs), ratio_cell(row),
                row.wanted + (row.fine() ? "" : " MISSED")});
  });
  text::Table growths({{"cost grows with"}, {"as its power"}, {"beside"}, {"theirs"}});
  for_each(results, BenchRow::Kind::growth, [&](const BenchRow& row) {
    growths.add({row.what + ", " + row.unit, row.ours, or_dash(row.yardstick), or_dash(row.theirs)});
  });
  return text::wrapped(joined(results.machine), 2, kTableColumns) + "\n\n" + ratios.to_text(colour, kTableColumns) +
         "\n  Times in us. The CSV file also has the ratios of single runs.\n\n" +
         growths.to_text(text::Colour::none, kTableColumns);
}

std::string to_markdown(const BenchResults& results) { return "```\n" + to_table(results) + "```\n"; }

}  // namespace forcebound::lab
