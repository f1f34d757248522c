#include "tests/tools/lab/accuracy/study_markdown.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "forcebound/text/file.hpp"
#include "tests/support/source_folder.hpp"
#include "tests/tools/lab/accuracy/study_text.hpp"

namespace forcebound::lab {
namespace {

using testing::HasSubstr;

StudiedSetting setting(const std::string& value, double step_us, double near, double far) {
  StudiedSetting made{.value = value, .cost = {.median_us = step_us}};
  made.at_states.force = 0.5 * near;
  made.behind.push_back({.round_trip_s = 1e-3, .error = {.total = near}});
  made.behind.push_back({.round_trip_s = 0.05, .error = {.total = far}});
  return made;
}

StudyResult two_settings() {
  StudyResult result{.key = "a.b", .hand = "press", .reference_why = "exact"};
  result.settings.push_back(setting("1", 20, 0.4, 0.5));
  result.settings.push_back(setting("2", 900, 0.1, 0.6));
  return result;
}

TEST(StudyMarkdown, HasARowForEachSettingAndTheBestBehindEachNetworkInBold) {
  EXPECT_EQ(to_markdown(to_json(two_settings())),
            "Reference: exact, uncertain to 0 %. Hand: press.\n\n"
            "| `a.b` | a step [us] | model alone | behind 1 ms | behind 50 ms |\n"
            "|---|---|---|---|---|\n"
            "| 1 | 20 | 20 % | 40 % | **50 %** |\n"
            "| 2 | 900 | 5 % | **10 %** | 60 % |\n");
}

TEST(StudyMarkdown, SaysWhatFailedAndNeverCallsItTheBest) {
  StudyResult result = two_settings();
  result.settings[1].trouble = "not converged";
  EXPECT_THAT(to_markdown(to_json(result)), HasSubstr("| 2, failed: not converged | 900 | 5 % | 10 % | 60 % |\n"));
  EXPECT_THAT(to_markdown(to_json(result)), HasSubstr("| 1 | 20 | 20 % | **40 %** | **50 %** |\n"));
}

TEST(StudyMarkdown, NeverCallsASettingBestThatIsNotPassive) {
  StudyResult result = two_settings();
  result.same_scene = true;
  result.settings[1].behind[0].passivity_minimum_J = -0.01;
  EXPECT_THAT(to_markdown(to_json(result)), HasSubstr("| 1 | 20 | 20 % | **40 %** | **50 %** |\n"));
}

TEST(Page, QuotesTheCommittedStudyAndNoOther) {
  const std::string root = test::source_folder().string();
  const auto committed = nlohmann::ordered_json::parse(text::read_file(root + "/deploy/accuracy-results.json"));
  EXPECT_EQ(text::between_marks(text::read_file(root + "/tests/tools/lab/README.md"), kAccuracyMarks),
            to_markdown(committed))
      << "the study in tests/tools/lab/README.md is not that of deploy/accuracy-results.json: run deploy/accuracy";
}

}  // namespace
}  // namespace forcebound::lab
