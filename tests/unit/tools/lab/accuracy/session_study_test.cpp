#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/process.hpp"
#include "tests/tools/lab/accuracy/levels_text.hpp"
#include "tests/tools/lab/accuracy/recommendation.hpp"
#include "tests/tools/lab/accuracy/study_text.hpp"
#include "tests/unit/tools/lab/accuracy/floor_study.hpp"

namespace forcebound::lab {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

StudyResult swept(double round_trip_s, const std::string& sweep) {
  Study study = floor_study(round_trip_s);
  study.sweep = parse_sweep(sweep);
  return carry_out(study, EvenClock());
}

const DeviceError& error_of(const StudyResult& result, std::size_t setting) {
  return result.settings[setting].behind[0].error;
}

double sum_of_parts(const DeviceError& error) {
  return error.model.share + error.extrapolation.share + error.age.share + error.hold.share + error.bounding.share;
}

TEST(StudyOfASession, HasARowForEachLawWhosePartsAddUp) {
  const StudyResult result = swept(0.05, "law=none,fba-less,fba-more,fba-exact");
  ASSERT_EQ(result.settings.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    SCOPED_TRACE(result.settings[i].value);
    const DeviceError& error = error_of(result, i);
    EXPECT_NEAR(sum_of_parts(error), error.total, 1e-9);
    EXPECT_EQ(error.extrapolation.alone, 0) << "all forces are the server's";
    EXPECT_NEAR(error.model.alone, 0, 0.01) << "the scene is its own reference";
    EXPECT_EQ(result.settings[i].at_states.force, 0);
    EXPECT_EQ(result.settings[i].cost.median_us, 50);
  }
  EXPECT_EQ(error_of(result, 0).bounding.alone, 0) << "no law takes anything away";
  EXPECT_GT(error_of(result, 2).bounding.alone, 0.1);
}

TEST(StudyOfASession, ForcesThatFadeBeforeTheyArriveAddToTheHold) {
  const StudyResult result = swept(0.05, "hold_ms=250,0");
  EXPECT_LT(error_of(result, 0).hold.alone, 0.2);
  EXPECT_GT(error_of(result, 1).hold.alone, error_of(result, 0).hold.alone + 0.01);
  EXPECT_EQ(error_of(result, 1).least_age, error_of(result, 0).least_age);
  EXPECT_EQ(result.settings[0].value, "250")
      << "in the order that they were given in: no setting is finer than another";
}

TEST(StudyOfASession, AServerThatAnswersRarelyIsWrongForItsAgeAndHold) {
  const StudyResult result = swept(0.001, "rate_Hz=20,1000");
  EXPECT_GT(result.settings[0].behind[0].turns_missed, 0.9);
  EXPECT_GT(error_of(result, 0).least_age, std::chrono::milliseconds(50));
  EXPECT_GT(error_of(result, 0).total, 3 * error_of(result, 1).total);
}

TEST(StudyOfASession, LocalRenderingTakesTheAgeAwayAndItsPartsAddUp) {
  const StudyResult result = swept(0.05, "rendering=remote,local");
  const DeviceError& remote = error_of(result, 0);
  const DeviceError& local = error_of(result, 1);
  EXPECT_NEAR(sum_of_parts(remote), remote.total, 1e-9);
  EXPECT_NEAR(sum_of_parts(local), local.total, 1e-9);
  EXPECT_GT(remote.age.alone, 0.1);
  EXPECT_EQ(remote.extrapolation.alone, 0);
  EXPECT_LT(local.age.alone, 0.01);
  EXPECT_LT(local.total, 0.1 * remote.total);
}

TEST(StudyOfASession, OfTissueThatIsExtrapolatedAddsUpToo) {
  Study study = floor_study(0.02);
  study.scene_text = server::scene_source("pad").text + "large_motion = true\n";
  study.device = "firm-3dof";
  study.session.renders_locally = true;
  study.sweep = parse_sweep("law=none,fba-exact");
  const StudyResult result = carry_out(study, EvenClock());
  for (std::size_t i = 0; i < 2; ++i) {
    const DeviceError& error = error_of(result, i);
    EXPECT_NEAR(sum_of_parts(error), error.total, 1e-9) << result.settings[i].value;
    EXPECT_GT(error.extrapolation.alone, 0) << result.settings[i].value;
  }
  EXPECT_GT(result.extrapolation_per_s, 0);
}

TEST(StudyOfASession, TellsAnAutoSceneHowFastWhatIsMissedOfBodiesGrows) {
  Study study = floor_study(0.001);
  study.scene_text = server::scene_source("blocks").text;
  study.round_trips_s.push_back(0.1);
  study.session = {.renders_locally = true};
  study.sweep = parse_sweep("bodies.timestep_s=0.002,0.001");
  const StudyResult result = carry_out(study, EvenClock());
  double grown_by = 0;
  for (const StudiedSetting& setting : result.settings) {
    EXPECT_GT(setting.behind[0].error.extrapolation.alone, 0.01) << "at any age";
    grown_by += setting.behind[1].error.extrapolation.alone - setting.behind[0].error.extrapolation.alone;
  }
  EXPECT_NEAR(result.extrapolation_per_s, grown_by / 2 / 0.099, 0.02);
  constexpr std::string_view kShared = "shared = true\nclients_max = 4\n";
  std::string text = study.scene_text;
  text.replace(text.find(kShared), kShared.size(), "accuracy = 'auto'\n");
  const auto scene = server::parse_scene(text + levels_text(result), "blocks.toml");
  EXPECT_NEAR(scene->accuracy()->change_locally_per_s, result.extrapolation_per_s, 0.01);
}

TEST(StudyOfASession, PressesAgainstASurfaceAcrossAnyAxis) {
  for (const char* const scene : {"sphere", "wall"}) {
    SCOPED_TRACE(scene);
    Study study = floor_study(0.001);
    study.scene_text = server::scene_source(scene).text;
    study.sweep = parse_sweep("law=none,fba-exact");
    const StudyResult result = carry_out(study, EvenClock());
    EXPECT_NEAR(result.settings[0].at_states.penetration_m, 0.003, 0.002) << "of 6 mm at most, not yielding";
  }
}

TEST(StudyOfASession, PrintsTheScenesResultsOnce) {
  const StudyResult result = swept(0.001, "law=none,fba-exact");
  const std::string text = to_text(result);
  EXPECT_THAT(text, AllOf(HasSubstr("the scene itself"), HasSubstr("(all)"), HasSubstr("Session: law none")));
  EXPECT_THAT(recommendation(result), HasSubstr("law = "));
  EXPECT_EQ(what_does_not_matter(result), "");
  EXPECT_THROW(static_cast<void>(levels_text(result)), std::runtime_error);
}

TEST(StudyOfASession, OfAnotherReferenceHasItsModelsErrorInAllRows) {
  Study study = floor_study(0.001);
  study.reference = compile(study, {{"object.floor.surface.stiffness_N_per_m", "200"}});
  study.sweep = parse_sweep("law=none,fba-less");
  const StudyResult result = carry_out(study, EvenClock());
  for (const StudiedSetting& setting : result.settings) EXPECT_NEAR(setting.at_states.force, 0.5, 1e-9);
  EXPECT_NEAR(error_of(result, 0).model.alone, 0.5, 0.05);
}

TEST(StudyOfASession, IsRefusedBeforeAnythingRuns) {
  EXPECT_THROW(static_cast<void>(swept(0.001, "law=none,fab")), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(swept(0.001, "hold_ms=2000")), std::invalid_argument);
}

class StudyOfARecordedHand : public testing::Test {
 protected:
  /// Down into the floor and up again; `bottom_m` of its lowest.
  [[nodiscard]] std::string recording(const std::string& bottom_m) const {
    test::write_file(folder_.file("hand.csv"),
                     "time_s,x_m,y_m,z_m\n0,0,0,0.01\n0.5,0,0," + bottom_m + "\n1,0,0,0.01\n");
    return "replay:" + folder_.file("hand.csv");
  }

  [[nodiscard]] static Study by(const std::string& hand) {
    Study study = floor_study(0.005);
    study.sweep = {"object.floor.surface.stiffness_N_per_m", {"50", "100"}};
    study.reference = compile(study);
    study.hand = hand;
    return study;
  }

  test::TemporaryFolder folder_;
};

TEST_F(StudyOfARecordedHand, IsUsedInEveryRun) {
  const StudyResult result = carry_out(by(recording("-0.005")), EvenClock());
  EXPECT_THAT(result.hand, HasSubstr("hand.csv"));
  EXPECT_NEAR(result.settings[0].at_states.force, 0.5, 1e-9);
  EXPECT_EQ(result.settings[1].at_states.force, 0);
  EXPECT_GT(error_of(result, 1).age.share, 0.01);
}

TEST_F(StudyOfARecordedHand, GoesWhereTheSurfaceIsByItsOffset) {
  const std::string above = recording("0.005");
  EXPECT_THAT([&] { static_cast<void>(carry_out(by(above), EvenClock())); },
              testing::ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("never touches the scene"), HasSubstr("offset_z_m"), HasSubstr("(0, 0, 0) m"))));
  const StudyResult result = carry_out(by(above + ",offset_z_m=-0.01"), EvenClock());
  EXPECT_NEAR(result.settings[0].at_states.force, 0.5, 1e-9);
}

TEST_F(StudyOfARecordedHand, IsRefusedWithFileAndLine) {
  test::write_file(folder_.file("bad.csv"), "time_s,x_m,y_m,z_m\n0,0,0,0\n0.1,0,zero,0\n");
  EXPECT_THAT([&] { static_cast<void>(carry_out(by("replay:" + folder_.file("bad.csv")), EvenClock())); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("bad.csv:3: ")));
}

}  // namespace
}  // namespace forcebound::lab
