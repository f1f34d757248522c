#include "tests/tools/lab/bench/results.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <stdexcept>

#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"
#include "tests/support/source_folder.hpp"
#include "tests/tools/lab/bench/collect.hpp"

namespace forcebound::lab {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

BenchResults sample() {
  BenchResults results;
  results.machine = {{"date", "2026-11-21"}, {"processor", "some (2)"}};
  results.rows = {
      ratio_row("round trip: median", "us", 30, "sockperf", 25, "<= 1.25"),
      ratio_row("round trip: p99", "us", 60, "sockperf", 40, "<= 1.3"),
      turns_row("most clients", "clients", "processors kept awake", {400, 500, 300}, "echo", {600, 500, 600}, ">= 0.7"),
      ratio_row("law", "us", 0.123456, "no law", 0.1),
      growth_row("law", "degrees of freedom", 0.7),
      growth_row("nearest point", "triangles", 0.25, "Embree", 0.2)};
  return results;
}

TEST(BenchRow, PassesUpToItsBound) {
  const BenchResults results = sample();
  EXPECT_TRUE(results.rows[0].fine());
  EXPECT_FALSE(results.rows[1].fine());
  EXPECT_FALSE(results.rows[2].fine());
  EXPECT_TRUE(ratio_row("most clients", "clients", 420, "echo", 600, ">= 0.7").fine());
  EXPECT_TRUE(results.rows[3].fine());
  EXPECT_TRUE(results.rows[4].fine());
}

TEST(BenchRow, RefusesAResultThatIsNotFinite) {
  EXPECT_THROW(static_cast<void>(ratio_row("x", "us", 1, "y", 0)), std::runtime_error);
  EXPECT_THROW(static_cast<void>(ratio_row("x", "us", NAN, "y", 1)), std::runtime_error);
}

TEST(BenchRow, OfTurnsNeedsBothSidesAsOften) {
  EXPECT_THAT(
      [] {
        static_cast<void>(turns_row("x", "us", "", {1, 2}, "y", {1}));
      },
      ThrowsMessage<std::runtime_error>(HasSubstr("x: 2 runs of ours beside 1 of y")));
  EXPECT_EQ(turns_row("x", "us", "", {1}, "y", {2}).spread, "");
}

TEST(BenchCsv, ReadsBackAsItWas) { EXPECT_EQ(parse_bench_csv(to_csv(sample()), "x.csv"), sample()); }

TEST(BenchCsv, IsRefusedWithTheLineThatIsWrong) {
  // Two lines of the machine, the header and six results come before.
  EXPECT_THAT([] { static_cast<void>(parse_bench_csv(to_csv(sample()) + "ratio,short\n", "x.csv")); },
              ThrowsMessage<std::runtime_error>("x.csv:10: not a result: 'ratio,short'"));
  EXPECT_THAT([] { static_cast<void>(parse_bench_csv("what,ever\n", "x.csv")); },
              ThrowsMessage<std::runtime_error>(AllOf(StartsWith("x.csv:1: "), HasSubstr("'what,ever'"))));
  EXPECT_THAT([] { static_cast<void>(parse_bench_csv("", "x.csv")); },
              ThrowsMessage<std::runtime_error>(StartsWith("x.csv:1: no results")));
}

TEST(BenchCsv, RefusesToWriteACellThatWouldBecomeTwo) {
  BenchResults results = sample();
  results.rows[0].what = "a, b";
  EXPECT_THROW(static_cast<void>(to_csv(results)), std::runtime_error);
}

TEST(BenchTable, MarksWhatMissesItsBoundAndNothingElse) {
  const std::string table = to_table(sample());
  EXPECT_THAT(table, testing::ContainsRegex(" 1.5 +<= 1.3 MISSED\n"));
  EXPECT_THAT(table, testing::ContainsRegex(" 0.667 +>= 0.7 MISSED\n"));
  EXPECT_THAT(table, testing::ContainsRegex(" 1.2 +<= 1.25\n"));
}

TEST(BenchTable, HasARowOfTheCommittedResultsOnOneLineOf100Columns) {
  const std::string file = (test::source_folder() / "deploy/bench-results.csv").string();
  const BenchResults committed = parse_bench_csv(text::read_file(file), file);
  const std::string table = to_table(committed);
  for (const auto line : text::split(table, '\n')) EXPECT_LE(line.size(), 100U) << line;
  for (const BenchRow& row : committed.rows) {
    if (row.kind != BenchRow::Kind::ratio) continue;
    const auto tells = [&](std::string_view line) {
      return line.starts_with(row.what + " ") && line.find(" " + row.ours + " ") != std::string_view::npos &&
             line.find(" " + row.yardstick + " ") != std::string_view::npos &&
             line.find(" " + row.ratio) != std::string_view::npos;
    };
    EXPECT_TRUE(std::ranges::any_of(text::split(table, '\n'), tells)) << row.what;
  }
}

TEST(Collect, NamesWhatIsMissing) {
  EXPECT_THAT([] { static_cast<void>(collect("/nowhere")); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/nowhere/machine.txt")));
}

// deploy/bench --readme puts them there.
TEST(Page, QuotesTheCommittedBenchmarkResultsAndNoOthers) {
  const std::string root = test::source_folder().string();
  const std::string file = root + "/deploy/bench-results.csv";
  const BenchResults committed = parse_bench_csv(text::read_file(file), file);
  EXPECT_EQ(text::between_marks(text::read_file(root + "/tests/benchmark/README.md"), kBenchMarks),
            to_markdown(committed))
      << "the benchmarks in tests/benchmark/README.md are not those of deploy/bench-results.csv: run deploy/bench "
         "--readme";
}

TEST(Page, WithAnotherNumberFailsTheCheck) {
  BenchResults other = sample();
  other.rows[0].ours = "31";
  EXPECT_THAT(to_markdown(sample()), Not(testing::StrEq(to_markdown(other))));
}

}  // namespace
}  // namespace forcebound::lab
