#include "forcebound/results/runs_table.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/file.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::results {
namespace {

using Json = nlohmann::ordered_json;
using testing::ElementsAre;

/// The words of one line; the first two lines are the head.
std::vector<std::string> words_of_line(const std::string& table, int line) {
  std::istringstream lines(table);
  std::string text;
  for (int i = 0; i <= line; ++i) std::getline(lines, text);
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

Json summary_of(const char* law, double least_P_J) {
  return {{"law", law},
          {"rendering", {{"asked", "local"}, {"model_trust", 0.752}}},
          {"force_age_ms", {{"p50", 104.2}, {"p99", 121.76}, {"max", 300.0}}},
          {"force_N", {{"mean", 1.0}, {"variance", 0.12345}, {"max", 3.3}}},
          {"displayed_stiffness_N_per_m", {{"mean", 312.4}, {"median", 298.6}}},
          {"verdict", least_P_J >= 0 ? "passive" : "not passive"},
          {"passivity", {{"minimum_J", least_P_J}, {"final_J", 1.0}}}};
}

TEST(ReadSummary, RefusesWhatIsNone) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("a.json");
  text::write_file(file, summary_of("none", 0).dump());
  EXPECT_EQ(read_summary(file), summary_of("none", 0));
  for (const char* const other : {"{}", "[]", "not JSON", R"({"laws": [], "networks": []})"}) {
    text::write_file(file, other);
    EXPECT_THAT([&] { (void)read_summary(file); },
                testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr(file + ": not a summary")));
  }
}

TEST(ComparisonTable, GivesEachRunALineInItsOrder) {
  const std::string table =
      comparison_table({{"a.json", summary_of("none", -1.25)}, {"b.mcap", summary_of("fba-more", 0.0)}});
  EXPECT_THAT(words_of_line(table, 2), ElementsAre("a.json", "none", "local", "-1250", "0.1235", "299", "104.2", "75"));
  EXPECT_THAT(words_of_line(table, 3), ElementsAre("b.mcap", "fba-more", "local", "0", "0.1235", "299", "104.2", "75"));
}

TEST(ComparisonTable, ShowsWhatIsUnknownAsUnknown) {
  Json summary = summary_of("fba-less", 0.0);
  summary["passivity"] = {{"minimum_J", nullptr}};
  summary.erase("force_age_ms");
  summary["rendering"] = {{"asked", "remote"}, {"model_trust", nullptr}};
  EXPECT_THAT(words_of_line(comparison_table({{"a.json", summary}}), 2),
              ElementsAre("a.json", "fba-less", "remote", "-", "0.1235", "299", "-", "-"));
  EXPECT_THAT(words_of_line(comparison_table({{"a.json", Json::object()}}), 2),
              ElementsAre("a.json", "-", "-", "-", "-", "-", "-", "-"));
}

TEST(ComparisonTable, SaysWhyThereAreDashesWhereAHandNeverTouched) {
  const auto with_contact = [](int ticks) {
    Json summary = summary_of("none", 0);
    summary["contact_ticks"] = ticks;
    return summary;
  };
  EXPECT_THAT(comparison_table({{"a.json", with_contact(0)}}), testing::HasSubstr("the hand never touched the scene:"));
  EXPECT_THAT(comparison_table({{"a.json", with_contact(0)}, {"b.json", with_contact(5)}}),
              testing::HasSubstr("the hand never touched the scene in 1 of 2:"));
  EXPECT_THAT(comparison_table({{"a.json", with_contact(5)}}), testing::Not(testing::HasSubstr("never touched")));
}

TEST(ComparisonTable, MarksARunThatWasNotPassive) {
  EXPECT_EQ(least_P_cell(summary_of("none", -1.25)).mark, text::Table::Mark::alarm);
  EXPECT_EQ(least_P_cell(summary_of("none", 0.0)).mark, text::Table::Mark::none);
}

TEST(ComparisonTable, HasAUnitOverEachNumber) {
  EXPECT_THAT(words_of_line(comparison_table({}), 1), ElementsAre("[mJ]", "[N^2]", "[N/m]", "[ms]", "[%]"));
}

TEST(ComparisonTable, ShowsALeastPWithinRoundingAsZero) {
  EXPECT_EQ(words_of_line(comparison_table({{"a.json", summary_of("none", -1e-9)}}), 2)[3], "0");
  EXPECT_EQ(words_of_line(comparison_table({{"a.json", summary_of("none", -2e-9)}}), 2)[3], "-2e-06");
}

TEST(ComparisonTable, NamesFilesAsBrieflyAsTellsThemApart) {
  const Json run = summary_of("none", 0.0);
  const std::string table = comparison_table({{"out/less/run.mcap", run}, {"out/more/run.mcap", run}, {"c.json", run}});
  EXPECT_EQ(words_of_line(table, 2)[0], "less/run.mcap");
  EXPECT_EQ(words_of_line(table, 3)[0], "more/run.mcap");
  EXPECT_EQ(words_of_line(table, 4)[0], "c.json");
  const std::string same = comparison_table({{"out/run.mcap", run}, {"out/run.mcap", run}});
  EXPECT_EQ(words_of_line(same, 2)[0], "run.mcap");
}

}  // namespace
}  // namespace forcebound::results
