#include "forcebound/server/environment/scene_parser.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "forcebound/scene/effects/surface.hpp"

namespace forcebound::server {
namespace {

using testing::StartsWith;

constexpr std::string_view kGood = R"([scene]
name = "wall"
description = "a wall"
degrees_of_freedom = 2

[[object]]
name = "wall"
shape = { kind = "half_space", through_m = [0, 0], normal = [-1, 0] }
effects = ["surface"]

[object.surface]
stiffness_N_per_m = 200
damping_N_s_per_m = 1
)";

/// The valid scene's text with one passage replaced.
std::string with(std::string_view from, std::string_view to) {
  std::string text{kGood};
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the good scene has no " + std::string(from));
  return text.replace(at, from.size(), to);
}

/// What is said of an effect that nobody knows does not change here with every new one.
/// With some shapes.
scene::Registry surface_alone() {
  scene::Registry registry;
  registry.add(scene::surface_effect());
  registry.add(scene::half_space_shape());
  registry.add(scene::sphere_shape());
  registry.add(scene::box_shape());
  return registry;
}

std::string error_of(const std::string& text) {
  try {
    (void)parse_scene(text, "scenes/wall.toml", surface_alone());
  } catch (const SceneError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ParseScene, ReadsAGoodScene) {
  const auto scene = parse_scene(kGood, "scenes/wall.toml");
  EXPECT_EQ(scene->facts().name, "wall");
  EXPECT_EQ(scene->facts().description, "a wall");
  EXPECT_EQ(scene->facts().degrees_of_freedom, 2);
  ASSERT_EQ(scene->objects().size(), 1u);
  EXPECT_EQ(scene->objects()[0].effects[0].parameters, "stiffness_N_per_m 200, damping_N_s_per_m 1");
  EXPECT_TRUE(scene->plan().inputs().velocity);
}

TEST(ParseScene, SameTextSameHash) {
  EXPECT_EQ(parse_scene(kGood, "a.toml")->facts().hash, parse_scene(kGood, "b.toml")->facts().hash);
  EXPECT_NE(parse_scene(kGood, "a.toml")->facts().hash, parse_scene(with("= 200", "= 201"), "a.toml")->facts().hash);
}

TEST(ParseScene, TakesAWholeNumberHoweverItIsWritten) {
  EXPECT_EQ(
      parse_scene(with("degrees_of_freedom = 2", "degrees_of_freedom = 2.0"), "a.toml")->facts().degrees_of_freedom, 2);
}

TEST(ParseScene, DampingMayBeLeftOut) {
  EXPECT_FALSE(parse_scene(with("damping_N_s_per_m = 1\n", ""), "a.toml")->plan().inputs().velocity);
}

TEST(ParseScene, NamesFileLineObjectEffectAndValue) {
  EXPECT_EQ(
      error_of(with("= 200", "= -200")),
      "scenes/wall.toml:12: object 'wall', effect 'surface': stiffness_N_per_m must be > 0 and <= 1e+09, got -200");
  EXPECT_EQ(
      error_of(with("damping_N_s_per_m = 1", "damping_N_s_per_m = -1")),
      "scenes/wall.toml:13: object 'wall', effect 'surface': damping_N_s_per_m must be >= 0 and <= 1e+06, got -1");
}

TEST(ParseScene, NumbersMustBeFiniteNumbers) {
  const std::string place =
      "scenes/wall.toml:12: object 'wall', effect 'surface': stiffness_N_per_m must be a finite number";
  EXPECT_EQ(error_of(with("= 200", "= nan")), place + ", got nan");
  EXPECT_EQ(error_of(with("= 200", "= inf")), place + ", got inf");
  EXPECT_EQ(error_of(with("= 200", "= 'hard'")), place + ", got 'hard'");
  EXPECT_EQ(error_of(with("[0, 0]", "[0, nan]")),
            "scenes/wall.toml:8: object 'wall', shape: through_m must be a finite number, got nan");
}

TEST(ParseScene, UnknownKeysAreErrorsWithTheNearestKnown) {
  EXPECT_EQ(error_of(with("damping_N_s_per_m", "damping_Ns_per_m")),
            "scenes/wall.toml:13: object 'wall', effect 'surface': unknown key 'damping_Ns_per_m', did you mean "
            "'damping_N_s_per_m'? (known: stiffness_N_per_m, damping_N_s_per_m, stiffening_N_per_m2)");
  EXPECT_EQ(
      error_of(with("degrees_of_freedom = 2", "degrees_of_freedom = 2\ndescripton = ''")),
      "scenes/wall.toml:5: scene: unknown key 'descripton', did you mean 'description'? (known: name, description, "
      "degrees_of_freedom, shared, clients_max, accuracy, suggested_device, suggested_hand)");
  EXPECT_EQ(
      error_of(with("[scene]", "[scenery]\n[scene]")),
      "scenes/wall.toml:1: scene file: unknown key 'scenery', did you mean 'scene'? (known: scene, accuracy, tool, "
      "object, field, bodies, body, tissue)");
  EXPECT_EQ(error_of(with("normal = [-1, 0] }", "normal = [-1, 0], radius_m = 1 }")),
            "scenes/wall.toml:8: object 'wall', shape: unknown key 'radius_m' (known: kind, through_m, normal)");
}

TEST(ParseScene, UnknownEffectsAndShapesAreErrorsWithTheNearestKnown) {
  EXPECT_EQ(error_of(with("[\"surface\"]", "[\"surfaces\"]")),
            "scenes/wall.toml:9: object 'wall': unknown effect 'surfaces', did you mean 'surface'? (known: surface)");
  const std::string said = error_of(with("half_space", "halfspace"));
  EXPECT_EQ(said.substr(0, said.find(',', 50)), "scenes/wall.toml:8: object 'wall', shape: unknown kind 'halfspace'")
      << said;
  EXPECT_NE(said.find("did you mean 'half_space'? (known: half_space, sphere, "), std::string::npos) << said;
}

TEST(ParseScene, MissingKeysAreNamed) {
  EXPECT_EQ(error_of(with("stiffness_N_per_m = 200\n", "")),
            "scenes/wall.toml:11: object 'wall', effect 'surface': 'stiffness_N_per_m' is missing (accepted: > 0 and "
            "<= 1e+09)");
  EXPECT_EQ(
      error_of(with("stiffness_N_per_m", "stifness_N_per_m")),
      "scenes/wall.toml:11: object 'wall', effect 'surface': 'stiffness_N_per_m' is missing, is 'stifness_N_per_m' "
      "a misspelling of it? (accepted: > 0 and <= 1e+09)");
  EXPECT_EQ(error_of(with("stiffness_N_per_m", "stiffness")),
            "scenes/wall.toml:11: object 'wall', effect 'surface': 'stiffness_N_per_m' is missing, is 'stiffness' a "
            "misspelling of it? (accepted: > 0 and <= 1e+09)");
  EXPECT_EQ(error_of(with("name = \"wall\"\nshape", "shape")),
            "scenes/wall.toml:6: object: 'name' is missing (accepted: 1 to 64 bytes without control characters)");
  EXPECT_EQ(error_of(with("effects = [\"surface\"]", "")),
            "scenes/wall.toml:6: object 'wall': 'effects' is missing (accepted: a list of names)");
  EXPECT_THAT(error_of(with("[\"surface\"]", "[]")),
              StartsWith("scenes/wall.toml:9: object 'wall': effects must name at least one of: surface"));
  EXPECT_EQ(error_of(""), "scenes/wall.toml:1: scene file: 'scene' is missing (accepted: a table)");
  EXPECT_EQ(error_of(with("kind = \"half_space\", ", "")),
            "scenes/wall.toml:8: object 'wall', shape: 'kind' is missing "
            "(accepted: half_space, sphere, box)");
  EXPECT_EQ(error_of(with("[object.surface]\nstiffness_N_per_m = 200\ndamping_N_s_per_m = 1\n", "")),
            "scenes/wall.toml:9: object 'wall', effect 'surface': 'stiffness_N_per_m' is missing (accepted: > 0 and <= "
            "1e+09)");
}

TEST(ParseScene, MisspeltTablesAreReportedFirst) {
  EXPECT_THAT(
      error_of(with("[[object]]", "[[objet]]")),
      StartsWith("scenes/wall.toml:6: scene file: unknown key 'objet', did you mean 'object'? (known: scene, "));
  EXPECT_EQ(error_of(with("[[object]]", "[object]")),
            "scenes/wall.toml:6: scene file: object must be tables, each [[object]]");
}

TEST(ParseScene, EffectsAreAskedForOnce) {
  EXPECT_EQ(error_of(with("[\"surface\"]", "[\"surface\", \"surface\"]")),
            "scenes/wall.toml:9: object 'wall': effect 'surface' is asked for twice");
}

TEST(ParseScene, ParametersOfAnEffectNobodyAskedForAreAnError) {
  scene::Registry registry = scene::Registry::standard();
  scene::EffectKind other = *registry.find_effect("surface");
  other.name = "other";
  registry.add(other);
  try {
    (void)parse_scene(with("[\"surface\"]", "[\"other\"]") + "[object.other]\nstiffness_N_per_m = 1\n", "a.toml",
                      registry);
    FAIL() << "no error";
  } catch (const SceneError& error) {
    EXPECT_STREQ(error.what(), "a.toml:11: object 'wall': effect 'surface' has parameters, but is not in effects");
  }
}

TEST(ParseScene, MakesOnlyWhatTheSceneAsksFor) {
  scene::Registry registry = surface_alone();
  registry.add(
      {.name = "bomb", .purpose = "", .law = "", .make = [](const scene::Values&) -> std::unique_ptr<scene::Effect> {
         throw std::logic_error("made an effect that the scene does not ask for");
       }});
  const auto scene = parse_scene(kGood, "a.toml", registry);
  EXPECT_EQ(scene->plan().effects().size(), 1u);
  EXPECT_EQ(scene->facts().effects_not_requested.size(), registry.effects().size() - 1);
  EXPECT_EQ(scene->facts().effects_not_requested.back(), "bomb");
}

TEST(ParseScene, PointsHaveTheScenesNumberOfRows) {
  EXPECT_EQ(error_of(with("[0, 0]", "[0, 0, 0]")),
            "scenes/wall.toml:8: object 'wall', shape: through_m must have 2 numbers in this scene, got [0, 0, 0]");
  EXPECT_EQ(error_of(with("degrees_of_freedom = 2", "degrees_of_freedom = \"any\"")),
            "scenes/wall.toml:8: object 'wall', shape: through_m must have 1 number in this scene, got [0, 0]");
}

TEST(ParseScene, DegreesOfFreedomAreOneToThreeOrAny) {
  const std::string expected = "scenes/wall.toml:4: scene: degrees_of_freedom must be 1, 2, 3 or \"any\", got ";
  EXPECT_EQ(error_of(with("degrees_of_freedom = 2", "degrees_of_freedom = 7")), expected + "7");
  EXPECT_EQ(error_of(with("degrees_of_freedom = 2", "degrees_of_freedom = 2.5")), expected + "2.5");
  EXPECT_EQ(error_of(with("degrees_of_freedom = 2", "degrees_of_freedom = \"all\"")), expected + "'all'");
}

TEST(ParseScene, ShapesWithoutExtentAreRefused) {
  EXPECT_EQ(error_of(with("normal = [-1, 0]", "normal = [0, 0]")),
            "scenes/wall.toml:8: object 'wall', shape: normal must not be zero");
  EXPECT_EQ(error_of(with("kind = \"half_space\", through_m = [0, 0], normal = [-1, 0]",
                          "kind = \"sphere\", center_m = [0, 0], radius_m = 0")),
            "scenes/wall.toml:8: object 'wall', shape: radius_m must be > 0 and <= 1000, got 0");
  EXPECT_EQ(error_of(with("kind = \"half_space\", through_m = [0, 0], normal = [-1, 0]",
                          "kind = \"box\", center_m = [0, 0], size_m = [1, -1]")),
            "scenes/wall.toml:8: object 'wall', shape: size_m must be > 0 and <= 1000 on every axis, got [1, -1]");
}

TEST(ParseScene, ObjectsHaveNamesOfTheirOwn) {
  const std::string object{kGood.substr(kGood.find("[[object]]"))};
  EXPECT_EQ(error_of(std::string(kGood) + object), "scenes/wall.toml:14: scene file: two [[object]] are named 'wall'");
}

TEST(ParseScene, NamesDifferAcrossAllKindsOfParts) {
  const std::string field =
      "[[field]]\nname = \"wall\"\neffects = [\"viscosity\"]\nviscosity = { damping_N_s_per_m = 1 }\n";
  try {
    (void)parse_scene(std::string(kGood) + field, "a.toml");
    ADD_FAILURE() << "no error";
  } catch (const SceneError& error) {
    EXPECT_STREQ(error.what(), "a.toml:14: scene file: [[object]] and [[field]] are named 'wall'");
  }
}

TEST(ParseScene, NamesMustFitALogLine) {
  EXPECT_EQ(error_of(with("name = \"wall\"\ndesc", "name = \"\"\ndesc")),
            "scenes/wall.toml:2: scene: name must have 1 to 64 bytes without control characters, got ''");
  EXPECT_EQ(error_of(with("name = \"wall\"\ndesc", "name = \"a\\nb\"\ndesc")),
            "scenes/wall.toml:2: scene: name must have 1 to 64 bytes without control characters, got 'a?b'");
}

TEST(ParseScene, InvalidTomlIsRefusedWithItsLine) {
  EXPECT_EQ(error_of("[scene]\nname = \n").substr(0, 20), "scenes/wall.toml:2: ");
  EXPECT_EQ(error_of("[[object]]\n[object]\n").substr(0, 20), "scenes/wall.toml:2: ");
}

}  // namespace
}  // namespace forcebound::server
