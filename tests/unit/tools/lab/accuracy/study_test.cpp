#include "tests/tools/lab/accuracy/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/accuracy/recommendation.hpp"
#include "tests/tools/lab/accuracy/study_text.hpp"
#include "tests/unit/tools/lab/accuracy/floor_study.hpp"

namespace forcebound::lab {
namespace {

using testing::HasSubstr;

constexpr double kAnyBudget = std::numeric_limits<double>::infinity();

StudiedSetting setting(double cost_us, const std::vector<double>& errors, const std::string& trouble = {}) {
  StudiedSetting made{.value = std::to_string(static_cast<int>(cost_us)), .cost = {.median_us = cost_us}};
  made.trouble = trouble;
  for (const double error : errors) {
    made.behind.push_back({.round_trip_s = 0.001, .error = {.total = error, .age = {.share = 0.9 * error}}});
  }
  return made;
}

TEST(BestSetting, IsTheLeastWrongThatWorkedWithinTheBudget) {
  const StudyResult result{.key = "k",
                           .hand = "",
                           .reference_why = "",
                           .settings = {setting(10, {0.5, 0.3}), setting(100, {0.2, 0.4}),
                                        setting(50, {0.1, 0.1}, "fell"), setting(1000, {0.1, 0.5})}};
  EXPECT_EQ(best_setting(result, 0, kAnyBudget), 3U);
  EXPECT_EQ(best_setting(result, 0, 500), 1U);
  EXPECT_EQ(best_setting(result, 1, kAnyBudget), 0U);
  EXPECT_EQ(best_setting(result, 0, 5), std::nullopt);
}

TEST(BestSetting, OfASessionIsPassive) {
  StudyResult result{
      .key = "law", .hand = "", .reference_why = "", .settings = {setting(10, {0.1}), setting(10, {0.9})}};
  result.settings[0].behind[0].passivity_minimum_J = -2e-6;
  EXPECT_EQ(best_setting(result, 0, kAnyBudget), 0U) << "a scene has no law to choose";
  result.same_scene = true;
  EXPECT_EQ(best_setting(result, 0, kAnyBudget), 1U);
  EXPECT_THAT(to_text(result), HasSubstr("not passive"));
  result.settings[1].behind[0].passivity_minimum_J = -1;
  EXPECT_EQ(best_setting(result, 0, kAnyBudget), std::nullopt);
  EXPECT_THAT(recommendation(result), HasSubstr("nothing that worked and stayed passive"));
}

TEST(WhatDoesNotMatter, IsAKeyWhoseModelsAreNegligibleBesideTheAge) {
  StudyResult result{
      .key = "detail", .hand = "", .reference_why = "", .settings = {setting(10, {1, 1}), setting(20, {1, 1})}};
  const auto set = [&](std::size_t which, std::size_t network, double model) {
    result.settings[which].behind[network].round_trip_s = network == 0 ? 0.001 : 0.05;
    result.settings[which].behind[network].error.model.alone = model;
    result.settings[which].behind[network].error.age.alone = 0.5;
  };
  for (const std::size_t network : {0U, 1U}) {
    set(0, network, 0.04);
    set(1, network, 0.01);
  }
  EXPECT_EQ(what_does_not_matter(result),
            "detail is negligible beside the network's age behind every round trip: the model's part of every "
            "setting is at most 8 % of the age's (the line is 10 %)\n");
  set(0, 0, 0.06);
  EXPECT_THAT(what_does_not_matter(result), HasSubstr("behind 50 ms: "));
  set(1, 1, 0.06);
  EXPECT_EQ(what_does_not_matter(result), "");
  result.settings[0].trouble = "fell";
  set(1, 1, 0.01);
  EXPECT_EQ(what_does_not_matter(result), "") << "one setting is no comparison";
}

/// A softened wall whose stiffness is swept, against the exact one.
Study wall(double round_trip_s) {
  Study study = floor_study(round_trip_s);
  study.sweep = {"object.floor.surface.stiffness_N_per_m", {"50", "90", "100"}};
  study.reference = compile(study);
  return study;
}

TEST(CarryOut, WithoutANetworkOnlyTheModelHasAnError) {
  const StudyResult result = carry_out(wall(0), EvenClock());
  ASSERT_EQ(result.settings.size(), 3U);
  EXPECT_NEAR(result.settings[0].at_states.force, 0.5, 1e-9);
  EXPECT_NEAR(result.settings[1].at_states.force, 0.1, 1e-9);
  EXPECT_EQ(result.settings[2].at_states.force, 0);
  EXPECT_NEAR(result.settings[0].behind[0].error.model.alone, 0.5, 0.02);
  EXPECT_EQ(result.settings[0].cost.median_us, 50);
  EXPECT_EQ(result.ticks_between_states, 0) << "a wall has no state";
  EXPECT_FALSE(result.settings[0].bodies);
  EXPECT_EQ(result.settings[0].trouble, "");
  EXPECT_EQ(result.settings[0].per_step.heap_operations.value_or(0), 0);
  EXPECT_GT(result.answer_bytes, 100U);
  EXPECT_EQ(result.server_step_us, 1000);
}

TEST(CarryOut, NamesTheHandThatTheFiguresHoldFor) {
  const Study study = wall(0);
  const StudyResult result = carry_out(study, EvenClock());
  EXPECT_THAT(result.assumptions, HasSubstr("hold for a hand of 0.1 kg, 1000 N/m and 5 N s/m"));
  EXPECT_THAT(result.assumptions, HasSubstr("presses from 2 mm above to 6 mm below (0, 0, 0) m, 3 times a second"));
  EXPECT_THAT(result.assumptions, HasSubstr("device cartesian-3dof without its encoder's steps"));
  EXPECT_THAT(to_text(result), HasSubstr(text::wrapped(result.assumptions, 2)));
  Study rare = study;
  rare.session.server_rate_Hz = 50;
  rare.motion.kind = HarmonicMotion::Kind::slide;
  const StudyResult other = carry_out(rare, EvenClock());
  EXPECT_EQ(other.server_step_us, 20000);
  EXPECT_THAT(other.assumptions, HasSubstr("slides 30 mm to and fro, 6 mm below"));
}

TEST(CarryOut, WithALongDelayTheAgesPartExceedsTheModels) {
  const DeviceError near = carry_out(wall(0.001), EvenClock()).settings[1].behind[0].error;
  const DeviceError far = carry_out(wall(0.05), EvenClock()).settings[1].behind[0].error;
  EXPECT_GT(near.model.share, near.age.share);
  EXPECT_GT(far.age.share, 3 * far.model.share);
  EXPECT_GT(far.total, near.total);
  EXPECT_GE(far.least_age, std::chrono::milliseconds(50));
}

TEST(CarryOut, AServerAtALowRateAddsToTheHold) {
  Study rare = wall(0);
  rare.session.server_rate_Hz = 50;
  const auto behind = carry_out(rare, EvenClock()).settings[2].behind[0];
  EXPECT_GT(behind.turns_missed, 0.9);
  EXPECT_GT(behind.error.hold.share, 0.02);
  EXPECT_EQ(behind.error.model.alone, 0);
}

TEST(Compile, NamesTheFilesLineAndWhatWasChanged) {
  const auto refusal_of = [](const std::vector<server::SceneChange>& changes) -> std::string {
    try {
      (void)compile(floor_study(0), changes);
    } catch (const server::SceneError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(refusal_of({{"object.floor.surface.stiffness_N_per_m", "-1"}}),
              testing::AllOf(testing::StartsWith("floor.toml:9: "), HasSubstr("stiffness_N_per_m must be"),
                             HasSubstr("(with object.floor.surface.stiffness_N_per_m=-1)")));
  EXPECT_THAT(refusal_of({{"object.floor.surface.stiffness", "1"}}), testing::StartsWith("floor.toml:9: "));
  EXPECT_THAT(refusal_of({{"object.flor.surface.stiffness_N_per_m", "1"}}),
              testing::StartsWith("floor.toml: no [[object]] named 'flor', did you mean 'floor'?"));
  EXPECT_THAT(refusal_of({{"object.floor.surface.stiffness_N_per_m", "1 2"}}),
              HasSubstr("as TOML writes it, got '1 2'"));
  EXPECT_THAT(refusal_of({{"object.floor.surface.stiffness_N_per_m", "1\nx = 2"}}), HasSubstr("as TOML writes it"));
}

TEST(CarryOut, RefusesLevelsThatAreNotInOrder) {
  Study study = wall(0);
  study.reference = nullptr;
  study.sweep.values = {"100", "50", "200"};
  EXPECT_THROW((void)carry_out(study, EvenClock()), std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::lab
