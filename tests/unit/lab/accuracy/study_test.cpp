#include "tests/lab/accuracy/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "forcebound/server/scene/scene_library.hpp"
#include "tests/lab/accuracy/study_text.hpp"
#include "tests/support/auto_scene.hpp"

namespace forcebound::lab {
namespace {

using testing::HasSubstr;

constexpr double kAnyBudget = std::numeric_limits<double>::infinity();

/// A clock on which every step takes as long: 50 us.
class EvenClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override { return time::Nanoseconds{50000 * ++looks_}; }

 private:
  mutable std::int64_t looks_ = 0;
};

StudiedSetting setting(double cost_us, const std::vector<double>& errors, const std::string& trouble = {}) {
  StudiedSetting made{.value = std::to_string(static_cast<int>(cost_us)), .cost = {.median_us = cost_us}};
  made.trouble = trouble;
  for (const double error : errors) {
    made.behind.push_back({.round_trip_s = 0.001, .error = {.total = error, .age = {.share = 0.9 * error}}});
  }
  return made;
}

TEST(SpacingOf, FallsFromCoarseToFine) {
  EXPECT_EQ(spacing_of("tissue.pad.shape.cells", "[8, 8, 4]"), 0.125);
  EXPECT_EQ(spacing_of("object.o.shape.cell_m", "0.004"), 0.004);
  EXPECT_EQ(spacing_of("bodies.timestep_s", "0.001"), 0.001);
  EXPECT_EQ(spacing_of("tissue.pad.contacts_max", "8"), 0.125);
  EXPECT_EQ(spacing_of("object.o.surface.stiffness_N_per_m", "100"), 0.01);
  EXPECT_EQ(spacing_of("tissue.pad.large_motion", "true"), std::nullopt);
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

TEST(Recommendation, SaysWhereASettingHardlyMatters) {
  const StudyResult alike{
      .key = "cell_m", .hand = "", .reference_why = "", .settings = {setting(10, {0.50}), setting(20, {0.51})}};
  EXPECT_THAT(recommendation(alike),
              HasSubstr("cell_m = 10, E_dev 50 %, 10 us a step; but cell_m hardly matters here"));
  const StudyResult other{
      .key = "cell_m", .hand = "", .reference_why = "", .settings = {setting(10, {0.50}), setting(20, {0.9})}};
  EXPECT_THAT(recommendation(other), testing::Not(HasSubstr("hardly")));
  EXPECT_THAT(recommendation(other, 1), HasSubstr("nothing that worked takes at most 1 us"));
}

TEST(UsualSweep, NeedsSomethingWithLevels) {
  EXPECT_THROW((void)usual_sweep(server::scene_source("wall").text), std::invalid_argument);
  EXPECT_EQ(usual_sweep(server::scene_source("palpation").text).key, "tissue.pad.shape.cells");
  EXPECT_EQ(usual_sweep(server::scene_source("blocks").text).key, "bodies.timestep_s");
  const Sweep pad = usual_sweep(server::scene_source("soft_pad").text);
  EXPECT_EQ(pad.values.size(), 5U);
  for (const std::string& value : pad.values) EXPECT_TRUE(spacing_of(pad.key, value)) << value;
  EXPECT_DOUBLE_EQ(spacing_of(pad.key, "[ 15, 15, 5 ]").value_or(0), 1.0 / 15);
  const Sweep levels = usual_sweep(test::kAutoWall);
  EXPECT_EQ(levels.key, "object.wall.surface.stiffness_N_per_m");
  EXPECT_THAT(levels.values, testing::ElementsAre("100.0", "200.0"));
  EXPECT_EQ(usual_sweep(server::scene_source("assembly").text).key, "body.peg in hole.iterations");
}

/// A softened wall whose stiffness is swept, against the one that is right.
Study wall(double round_trip_s) {
  const std::string text =
      "[scene]\nname = 'floor'\ndescription = ''\ndegrees_of_freedom = 3\n"
      "[[object]]\nname = 'floor'\nshape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }\n"
      "effects = ['surface']\nsurface = { stiffness_N_per_m = 100 }\n";
  Study study{.scene_text = text,
              .scene_file = "floor.toml",
              .sweep = {"object.floor.surface.stiffness_N_per_m", {"50", "90", "100"}}};
  study.round_trips_s = {round_trip_s};
  study.law = "none";
  study.duration_s = 1.5;
  study.reference = server::parse_scene(text, "floor.toml");
  return study;
}

TEST(CarryOut, BehindANetworkThatIsNoneOnlyTheModelIsWrong) {
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
}

TEST(CarryOut, BehindALongerWayTheAgeIsMoreThanTheModel) {
  const DeviceError near = carry_out(wall(0.001), EvenClock()).settings[1].behind[0].error;
  const DeviceError far = carry_out(wall(0.05), EvenClock()).settings[1].behind[0].error;
  EXPECT_GT(near.model.share, near.age.share);
  EXPECT_GT(far.age.share, 3 * far.model.share);
  EXPECT_GT(far.total, near.total);
  EXPECT_GE(far.least_age, std::chrono::milliseconds(50));
}

TEST(CarryOut, AServerThatIsAskedRarelyIsTheHoldsFault) {
  Study rare = wall(0);
  rare.server_turn_least_s = 0.02;
  const auto behind = carry_out(rare, EvenClock()).settings[2].behind[0];
  EXPECT_GT(behind.turns_missed, 0.9);
  EXPECT_GT(behind.error.hold.share, 0.02);
  EXPECT_EQ(behind.error.model.alone, 0);
}

TEST(CarryOut, RefusesLevelsThatAreNotInOrder) {
  Study study = wall(0);
  study.reference = nullptr;
  study.sweep.values = {"100", "50"};
  EXPECT_THROW((void)carry_out(study, EvenClock()), std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::lab
