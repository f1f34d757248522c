#include "tests/lab/accuracy/scene_variant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

namespace forcebound::lab {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::string_view kScene = R"(
[scene]
name = "s"
[bodies]
timestep_s = 0.001
[[tissue]]
name = "liver"
young_Pa = 5000
[[tissue]]
name = "pad"
shape = { kind = "block", cells = [4, 4, 2] }
)";

std::string error_of(const std::string& key, const std::string& value) {
  try {
    (void)scene_variant(kScene, key, value);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(ParseSweep, SeparatesAtCommasOutsideOfBracketsAndQuotes) {
  EXPECT_EQ(parse_sweep("a.b=1,2,3").key, "a.b");
  EXPECT_THAT(parse_sweep("a.b=1,2,3").values, ElementsAre("1", "2", "3"));
  EXPECT_THAT(parse_sweep("a=[4, 4, 2],[8,8,4]").values, ElementsAre("[4, 4, 2]", "[8,8,4]"));
  EXPECT_THAT(parse_sweep("a='x,y',{ b = 1, c = 2 }").values, ElementsAre("'x,y'", "{ b = 1, c = 2 }"));
}

TEST(ParseSweep, RefusesWhatIsNone) {
  EXPECT_THROW((void)parse_sweep("a"), std::invalid_argument);
  EXPECT_THROW((void)parse_sweep("=1"), std::invalid_argument);
  EXPECT_THROW((void)parse_sweep("a="), std::invalid_argument);
}

TEST(SceneVariant, ChangesAKeyAndNothingElse) {
  toml::table expected = toml::parse(kScene);
  expected["tissue"][1]["shape"]["cells"].as_array()->at(0).as_integer()->get() = 8;
  EXPECT_EQ(toml::parse(scene_variant(kScene, "tissue.pad.shape.cells", "[8, 4, 2]")), expected);
}

TEST(SceneVariant, LeavesOutTheLevelsOfAScene) {
  const std::string scene = "[scene]\nname = 's'\naccuracy = 'auto'\n[accuracy]\nkey = 'a.b'\n";
  EXPECT_EQ(toml::parse(without_levels(scene)), toml::parse("[scene]\nname = 's'\n"));
  EXPECT_EQ(toml::parse(without_levels(kScene)), toml::parse(kScene));
}

TEST(SceneVariant, AddsAKeyThatIsNew) {
  const toml::table changed = toml::parse(scene_variant(kScene, "tissue.liver.large_motion", "true"));
  EXPECT_EQ(changed["tissue"][0]["large_motion"].value<bool>(), true);
  EXPECT_EQ(toml::parse(scene_variant(kScene, "bodies.timestep_s", "0.002"))["bodies"]["timestep_s"].value<double>(),
            0.002);
}

TEST(SceneVariant, AddsTheTableOfBodiesToASceneThatHasSome) {
  const toml::table changed = toml::parse(scene_variant("[[body]]\nname = 'b'\n", "bodies.iterations", "3"));
  EXPECT_EQ(changed["bodies"]["iterations"].value<int>(), 3);
  EXPECT_THROW((void)scene_variant("[scene]\nname = 's'\n", "bodies.iterations", "3"), std::invalid_argument);
}

TEST(SceneVariant, SaysWhatIsNotThere) {
  EXPECT_THAT(error_of("tisue.pad.young_Pa", "1"), HasSubstr("no 'tisue', did you mean 'tissue'?"));
  EXPECT_THAT(error_of("tissue.pat.young_Pa", "1"), HasSubstr("no [[tissue]] named 'pat', did you mean 'pad'?"));
  EXPECT_THAT(error_of("scene.name.x", "1"), HasSubstr("'name' of the scene is no table"));
  EXPECT_THAT(error_of("scene.name", "1 2"), HasSubstr("scene.name must be a value as TOML writes it, got '1 2'"));
}

}  // namespace
}  // namespace forcebound::lab
