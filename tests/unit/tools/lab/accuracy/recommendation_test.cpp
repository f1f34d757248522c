#include "tests/tools/lab/accuracy/recommendation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/lab/accuracy/study_text.hpp"

namespace forcebound::lab {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Made {
  double cost_us = 0;
  double at_device = 0;
  double at_states = 0;
  double spread_us = 0;
};

StudiedSetting setting(const Made& made) {
  StudiedSetting studied{.value = std::to_string(static_cast<int>(made.cost_us)),
                         .cost = {.median_us = made.cost_us, .spread_us = made.spread_us}};
  studied.at_states.force = made.at_states;
  studied.behind.push_back(
      {.round_trip_s = 0.001, .error = {.total = made.at_device, .age = {.share = 0.9 * made.at_device}}});
  return studied;
}

StudyResult result_of(const std::vector<Made>& all) {
  StudyResult result{.key = "cell_m", .hand = "", .reference_why = ""};
  for (const Made& made : all) result.settings.push_back(setting(made));
  return result;
}

TEST(TimeSaved, CountsFromOnePercentOfTheServersStepOn) {
  StudyResult result = result_of({{.cost_us = 100}, {.cost_us = 109.9}, {.cost_us = 110}});
  EXPECT_FALSE(time_saved(result, 0, 1).counts());
  EXPECT_TRUE(time_saved(result, 0, 2).counts());
  EXPECT_EQ(time_saved(result, 0, 2).us, 10);
  EXPECT_LT(time_saved(result, 2, 0).us, 0);
  EXPECT_FALSE(time_saved(result, 2, 0).counts());
  result.server_step_us = 20000;
  EXPECT_FALSE(time_saved(result, 0, 2).counts()) << "10 us of a step of 20 ms";
}

TEST(TimeSaved, BelowTheTimingsOwnNoiseDoesNotCount) {
  const Made cheap{.cost_us = 100};
  EXPECT_TRUE(time_saved(result_of({cheap, {.cost_us = 150, .spread_us = 50}}), 0, 1).counts());
  EXPECT_FALSE(time_saved(result_of({cheap, {.cost_us = 150, .spread_us = 51}}), 0, 1).counts());
  StudyResult noisy = result_of({cheap, {.cost_us = 150}});
  noisy.settings[0].idle.spread_us = 60;
  EXPECT_FALSE(time_saved(noisy, 0, 1).counts()) << "a loop that does nothing scatters by more";
}

TEST(Recommendation, IsNothingInPlaceOfTheMostExactWhereNoTimeIsSaved) {
  // A mesh of 5,856 triangles, for which a rough level was once recommended.
  StudyResult result = result_of({{.cost_us = 0.42, .at_device = 0.200, .at_states = 0.46},
                                  {.cost_us = 0.45, .at_device = 0.201, .at_states = 0}});
  result.settings[0].value = "0.1";
  result.settings[1].value = "1";
  result.settings[0].at_states.direction_median_deg = 23;
  result.settings[0].at_states.direction_p95_deg = 41;
  EXPECT_EQ(best_setting(result, 0, 1e9), 0U) << "by the error at the device alone";
  EXPECT_THAT(recommendation(result),
              AllOf(HasSubstr("behind 1 ms: nothing recommended in place of cell_m = 1: 0.1 saves 0.03 us a step"),
                    HasSubstr("from 10 us on it counts"), HasSubstr("points 23 deg aside (p95 41 deg)"),
                    HasSubstr("1 % of the server's step of 1 ms"), Not(HasSubstr("cell_m = 0.1"))));
}

TEST(Recommendation, OfARougherSettingSaysWhatItSavesAndThatItsForcePointsAside) {
  StudyResult result = result_of(
      {{.cost_us = 20, .at_device = 0.3, .at_states = 0.2}, {.cost_us = 900, .at_device = 0.5, .at_states = 0.01}});
  EXPECT_THAT(recommendation(result),
              AllOf(HasSubstr("cell_m = 20, E_dev 30 %, 20 us a step, 880 us less than the most exact, 900\n"),
                    Not(HasSubstr("warning"))));
  result.settings[0].at_states.direction_p95_deg = kDirectionWarning_deg;
  EXPECT_THAT(recommendation(result), Not(HasSubstr("warning")));
  result.settings[0].at_states.direction_p95_deg = kDirectionWarning_deg + 1;
  EXPECT_THAT(recommendation(result), HasSubstr("warning: at the same states its force points 0 deg aside (p95 11"));
}

TEST(Recommendation, OfTheMostExactNeedsToSaveNothing) {
  EXPECT_THAT(recommendation(result_of({{.cost_us = 20, .at_device = 0.5, .at_states = 0.2},
                                        {.cost_us = 20.5, .at_device = 0.3, .at_states = 0.01}})),
              HasSubstr("behind 1 ms: cell_m = 20, E_dev 30 %, 20.5 us a step\n"));
}

TEST(Recommendation, IsNothingWhereNoErrorIsAboveTheReferencesUncertainty) {
  StudyResult result = result_of(
      {{.cost_us = 20, .at_device = 0.03, .at_states = 0.2}, {.cost_us = 900, .at_device = 0.5, .at_states = 0.01}});
  result.free_uncertainty = 0.7;
  EXPECT_THAT(recommendation(result),
              AllOf(HasSubstr("behind 1 ms: nothing recommended: every setting's E_dev is below "
                              "210 %"),
                    Not(HasSubstr("cell_m = 20"))));
  result.free_uncertainty = 0.1;
  EXPECT_THAT(recommendation(result), HasSubstr("cell_m = 20, E_dev <= 30 %, 20 us a step"));
}

TEST(Recommendation, OfASessionAsksNoTime) {
  StudyResult result = result_of({{.cost_us = 50, .at_device = 0.2}, {.cost_us = 50, .at_device = 0.4}});
  result.same_scene = true;
  result.settings[0].value = "fba-exact";
  EXPECT_THAT(recommendation(result), AllOf(HasSubstr("cell_m = fba-exact, E_dev 20 %"), Not(HasSubstr("saves"))));
}

TEST(Recommendation, SaysWhereASettingHardlyMatters) {
  const StudyResult alike = result_of({{.cost_us = 10, .at_device = 0.50}, {.cost_us = 20, .at_device = 0.51}});
  EXPECT_THAT(recommendation(alike),
              HasSubstr("cell_m = 10, E_dev 50 %, 10 us a step, 10 us less than the most exact, "
                        "20; but cell_m makes little difference here: the worst setting has 51 %"));
  const StudyResult other = result_of({{.cost_us = 10, .at_device = 0.50}, {.cost_us = 20, .at_device = 0.9}});
  EXPECT_THAT(recommendation(other), Not(HasSubstr("makes little difference")));
  EXPECT_THAT(recommendation(other, 1), HasSubstr("nothing that worked takes at most 1 us"));
}

}  // namespace
}  // namespace forcebound::lab
