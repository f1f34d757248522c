#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "forcebound/time/steady_clock.hpp"
#include "tests/tools/lab/accuracy/recommendation.hpp"
#include "tests/tools/lab/accuracy/study.hpp"
#include "tests/tools/lab/accuracy/study_text.hpp"
#include "tests/unit/tools/lab/accuracy/body_scenes.hpp"

namespace forcebound::lab {
namespace {

using testing::HasSubstr;

StudyResult study(const std::string& bodies, const Sweep& sweep, double duration_s = 0.9) {
  Study study{.scene_text = stack_text(bodies), .scene_file = "stack.toml", .sweep = sweep};
  study.round_trips_s = {0.001};
  study.session.law = "none";
  study.duration_s = duration_s;
  return carry_out(study, time::SteadyClock());
}

std::vector<double> errors_of(const StudyResult& result) {
  std::vector<double> errors;
  for (const StudiedSetting& setting : result.settings) errors.push_back(setting.at_states.force);
  return errors;
}

TEST(StudyOfAStack, ErrorDoesNotFallWithEveryIterationAndOnlyWhatWasTriedIsRecommended) {
  const std::vector<std::string> tried{"1", "3", "5", "50"};
  bool any_rises = false;
  for (const std::string solver : {"pgs", "cg", "newton"}) {
    SCOPED_TRACE(solver);
    const StudyResult result = study("solver = '" + solver + "'", {"bodies.iterations", tried});
    const std::vector<double> errors = errors_of(result);
    SCOPED_TRACE(testing::PrintToString(errors));
    EXPECT_THAT(result.reference_why, HasSubstr("newton, 1000 iterations at most, tolerance 1e-14"));
    EXPECT_LT(result.reference_uncertainty, 1e-4);
    EXPECT_EQ(result.reference_trouble, "");
    EXPECT_LT(errors.back(), 1e-2);
    any_rises = any_rises || !std::ranges::is_sorted(errors, std::ranges::greater_equal());
    const auto best = best_setting(result, 0, std::numeric_limits<double>::infinity());
    ASSERT_TRUE(best);
    EXPECT_EQ(result.settings[*best].trouble, "");
    // Where no time is saved the most exact one stays.
    EXPECT_THAT(recommendation(result), testing::AnyOf(HasSubstr("bodies.iterations = " + tried[*best] + ","),
                                                       HasSubstr("bodies.iterations = " + tried.back() + ":")));
  }
  EXPECT_TRUE(any_rises);
}

TEST(StudyOfAStack, AStackThatCollapsedIsACrossAndNeverTheBest) {
  const StudyResult result = study("solver = 'cg'", {"bodies.iterations", {"1", "100"}});
  EXPECT_NE(result.settings[0].trouble, "");
  EXPECT_EQ(result.settings[1].trouble, "");
  EXPECT_EQ(best_setting(result, 0, std::numeric_limits<double>::infinity()), 1U);
  EXPECT_THAT(to_text(result), HasSubstr("X " + result.settings[0].trouble));
}

TEST(StudyOfAStack, TimeStepsAreNotExtrapolated) {
  const StudyResult result = study("", {"bodies.timestep_s", {"0.002", "0.001", "0.0005"}});
  EXPECT_EQ(result.reference_order, 0);
  EXPECT_THAT(result.reference_why, testing::AllOf(HasSubstr("the finest level"), HasSubstr("observed order")));
  EXPECT_GT(result.reference_uncertainty, 0);
  EXPECT_EQ(result.ticks_between_states, 4);
  EXPECT_EQ(result.settings.back().at_states.force, 0) << "the finest is the reference";
}

TEST(StudyOfAStack, SolversNeedNoOrder) {
  const StudyResult result = study("", {"bodies.solver", {"'pgs'", "'cg'", "'newton'"}});
  EXPECT_EQ(result.settings.size(), 3U);
  EXPECT_LT(result.settings[2].at_states.force, result.settings[0].at_states.force);
}

}  // namespace
}  // namespace forcebound::lab
