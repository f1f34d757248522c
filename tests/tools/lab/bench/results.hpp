#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/text/marks.hpp"
#include "forcebound/text/terminal.hpp"

/// The results of deploy/bench: one text file, from which the table, the figure and the numbers in
/// tests/benchmark/README.md are made.
namespace forcebound::lab {

struct BenchRow {
  enum class Kind {
    ratio,   ///< ours and the reference's, in `unit`
    growth,  ///< exponents: cost grows as `unit` to the power of it
  };
  Kind kind = Kind::ratio;
  std::string what;
  std::string unit;
  std::string conditions;  ///< under which both sides ran, where there is a choice; may be empty
  std::string ours;        ///< a number
  std::string yardstick;   ///< whose `theirs` is; may be empty
  std::string theirs;      ///< a number, or empty
  std::string ratio;       ///< ours / theirs, or empty
  std::string spread;      ///< the least and the largest ratio of single runs, "0.9 to 1.2", or empty
  std::string wanted;      ///< such as "<= 1.25", or empty

  bool operator==(const BenchRow&) const = default;

  /// False if the ratio misses its bound.
  [[nodiscard]] bool fine() const;
};

struct BenchResults {
  std::vector<std::pair<std::string, std::string>> machine;  ///< such as {"cpu", "..."}
  std::vector<BenchRow> rows;

  bool operator==(const BenchResults&) const = default;
};

[[nodiscard]] BenchRow ratio_row(std::string what, std::string unit, double ours, std::string yardstick, double theirs,
                                 std::string wanted = {});
/// Of runs by turns: the medians of both sides, their ratio, and the ratios of the single turns.
/// @throws std::runtime_error unless both sides ran as often, at least once
[[nodiscard]] BenchRow turns_row(std::string what, std::string unit, std::string conditions,
                                 const std::vector<double>& ours, std::string yardstick,
                                 const std::vector<double>& theirs, std::string wanted = {});
[[nodiscard]] BenchRow growth_row(std::string what, std::string size, double ours, std::string yardstick = {},
                                  double theirs = 0);

/// "# key: value" for the machine, then comma-separated rows under a header.
[[nodiscard]] std::string to_csv(const BenchResults& results);

/// @param file its name, for messages
/// @throws std::runtime_error "FILE:LINE: ..." for a line that is not in to_csv's format
[[nodiscard]] BenchResults parse_bench_csv(std::string_view csv, const std::string& file);

/// The data of ratios.gnuplot: a row for each ratio. "-": no conditions; bound 0: none is required.
[[nodiscard]] std::string ratios_csv(const BenchResults& results);

/// For a terminal.
[[nodiscard]] std::string to_table(const BenchResults& results, text::Colour colour = text::Colour::none);

/// The same for tests/benchmark/README.md, as Markdown.
[[nodiscard]] std::string to_markdown(const BenchResults& results);

inline constexpr text::Marks kBenchMarks{"<!-- bench: made by deploy/bench --readme -->\n", "<!-- /bench -->\n"};

}  // namespace forcebound::lab
