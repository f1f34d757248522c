#include "forcebound/server/environment/accuracy_parser.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/calibrate.hpp"
#include "forcebound/server/environment/explain.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/support/auto_scene.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

double force_N(const std::shared_ptr<const scene::Scene>& scene) {
  scene::SceneState state(scene, 1);
  return state.answer(test::vector_of({0.01}), time::Nanoseconds{0}).force[0];
}

/// The wall's text with one passage replaced.
std::string error_with(std::string_view from, std::string_view to) {
  std::string text = test::kAutoWall;
  text.replace(text.find(from), from.size(), to);
  try {
    (void)parse_scene(text, "w.toml");
  } catch (const SceneError& error) {
    return error.what();
  }
  return "no error";
}

TEST(AutoScene, IsTheFilesSceneUntilAClientIsKnownAndThenOneOfItsLevels) {
  const auto scene = test::auto_wall();
  EXPECT_NEAR(force_N(scene), -1.5, 1e-12);
  ASSERT_NE(scene->accuracy(), nullptr);
  const auto& levels = scene->accuracy()->levels;
  ASSERT_EQ(levels.size(), 2U);
  EXPECT_NEAR(force_N(levels[0].scene), -1, 1e-12);
  EXPECT_NEAR(force_N(levels[1].scene), -2, 1e-12);
  EXPECT_EQ(levels[1].scene->accuracy(), nullptr);
  EXPECT_EQ(levels[1].scene->facts().name, "auto_wall");
  EXPECT_NE(levels[0].scene->facts().hash, levels[1].scene->facts().hash);
  EXPECT_NE(levels[0].scene->facts().hash, scene->facts().hash);
}

TEST(AutoScene, TakesTheCostOfEachLevelAsMeasuredOrElsePredicted) {
  const auto measured = test::auto_wall();
  EXPECT_EQ(measured->accuracy()->levels[0].step_s, 0);
  EXPECT_EQ(measured->accuracy()->levels[1].step_s, 2e-3);
  const auto predicted = parse_scene(test::kAutoWall, "w.toml");
  EXPECT_GT(predicted->accuracy()->levels[1].step_s, 10e-9);
  EXPECT_LT(predicted->accuracy()->levels[1].step_s, 10e-6);
  const time::SteadyClock clock;
  const auto here = parse_scene(test::kAutoWall, "w.toml", scene::Registry::standard(), measured_by(clock));
  EXPECT_GT(here->accuracy()->levels[1].step_s, 1e-9);
}

TEST(AutoScene, KnowsWhatAClientThatRendersLocallyIsLeftWith) {
  EXPECT_EQ(test::auto_wall()->accuracy()->change_locally_per_s, 0) << "the wall runs there";
  const auto pad_with = [](const std::string& key, const std::string& more = "large_motion = true\n") {
    return parse_scene(
        "[scene]\nname = 'p'\ndescription = ''\ndegrees_of_freedom = 3\naccuracy = 'auto'\n"
        "[accuracy]\nkey = 'tissue.pad.young_Pa'\nchange_per_s = 20\n" +
            key +
            "levels = [{ value = 1e4, model_error = 0.1 }, { value = 2e4, model_error = 0.01 }]\n"
            "[[tissue]]\nname = 'pad'\nyoung_Pa = 1e4\npoisson = 0.3\n"
            "shape = { kind = 'block', center_m = [0, 0, -0.01], size_m = [0.04, 0.04, 0.02], cells = [2, 2, 1] }\n"
            "held = { through_m = [0, 0, -0.0199], normal = [0, 0, 1] }\n" +
            more,
        "p.toml");
  };
  EXPECT_EQ(pad_with("extrapolation_per_s = 0.5\n", "")->accuracy()->change_locally_per_s, 0) << "it runs there too";
  EXPECT_EQ(pad_with("extrapolation_per_s = 0.5\n")->accuracy()->change_locally_per_s, 0.5);
  EXPECT_EQ(pad_with("")->accuracy()->change_locally_per_s, 20) << "it could be as bad as a held force";
}

TEST(AutoScene, ExplanationListsAllLevels) {
  EXPECT_THAT(explain(*test::auto_wall()),
              HasSubstr("accuracy auto: by the client's round trip, one of\n"
                        "  object.wall.surface.stiffness_N_per_m = 100: model 10 % off, 0 ns a motion predicted\n"
                        "  object.wall.surface.stiffness_N_per_m = 200: model 1 % off, 2 ms a motion predicted\n"
                        "  that is     200 behind 1 ms, 100 behind 5 ms, 100 behind 20 ms, 100 behind 50 ms\n"
                        "  locally     200 behind 1 ms, 200 behind 5 ms, 200 behind 20 ms, 200 behind 50 ms\n"));
}

TEST(AutoScene, RefusalNamesTheErrorAndItsPlace) {
  EXPECT_THAT(error_with("object.wall", "object.wal"),
              StartsWith("w.toml:11: accuracy, level 1: with object.wal.surface.stiffness_N_per_m = 100: no [[object]] "
                         "named 'wal', did you mean 'wall'?"));
  EXPECT_THAT(error_with("200.0", "-200.0"),
              HasSubstr("accuracy, level 2: with object.wall.surface.stiffness_N_per_m = "
                        "-200: w.toml:12: object 'wall', effect 'surface': "));
  EXPECT_THAT(error_with("model_error = 0.1 ", "model_eror = 0.1 "), HasSubstr("is 'model_eror' a misspelling of it?"));
  EXPECT_EQ(error_with("model_error = 0.1 ", "model_error = -1 "),
            "w.toml:11: accuracy, level 1: model_error must be >= 0 and <= 100, got -1");
  EXPECT_EQ(error_with("  { value = 200.0, model_error = 0.01 },\n", ""),
            "w.toml:10: accuracy: levels must be two or more, got 1");
  EXPECT_EQ(error_with("accuracy = \"auto\"\n", ""),
            "w.toml:6: scene file: [accuracy] is for scenes with accuracy = \"auto\" in [scene]");
  EXPECT_THAT(error_with("accuracy = \"auto\"", "accuracy = \"aut\""),
              StartsWith("w.toml:5: scene: unknown accuracy 'aut', did you mean 'auto'?"));
}

TEST(AutoScene, IsTheSameSceneForWhoeverFeelsIt) {
  EXPECT_EQ(error_with("object.wall.surface.stiffness_N_per_m", "scene.shared"),
            "w.toml:8: accuracy: key must be one of an object, a field, bodies or tissue, got 'scene.shared'");
}

TEST(AutoScene, ReportsErrorsOfTheWholeFileAsSuch) {
  EXPECT_THAT(error_with("\"half_space\"", "\"half_spce\""), StartsWith("w.toml:17: object 'wall', shape: unknown"));
}

TEST(AutoScene, CannotBeShared) {
  EXPECT_THAT(error_with("accuracy = \"auto\"", "accuracy = \"auto\"\nshared = true"),
              HasSubstr("accuracy cannot be \"auto\" in a shared scene"));
}

}  // namespace
}  // namespace forcebound::server
