#include "forcebound/server/environment/suggested_hand.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::shared_ptr<const scene::Scene> scene_of(const std::string& rest, const std::string& degrees_of_freedom = "3",
                                             const std::string& folder = "") {
  return parse_scene("[scene]\nname = 's'\ndescription = ''\ndegrees_of_freedom = " + degrees_of_freedom + "\n" + rest,
                     folder + "s.toml");
}

std::shared_ptr<const scene::Scene> scene_with_object(const std::string& shape,
                                                      const std::string& degrees_of_freedom = "3",
                                                      const std::string& folder = "") {
  return scene_of("[[object]]\nname = 'it'\neffects = ['surface']\nsurface = { stiffness_N_per_m = 100 }\nshape = { " +
                      shape + " }\n",
                  degrees_of_freedom, folder);
}

std::string refusal_of(const std::string& keys, const std::string& degrees_of_freedom = "3") {
  try {
    (void)scene_of(keys, degrees_of_freedom);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "no error";
}

void expect_touches(const std::shared_ptr<const scene::Scene>& scene) {
  const SuggestedHand suggested = suggested_hand(scene);
  SCOPED_TRACE(scene->facts().name + ": " + to_options(suggested));
  const HandTrial trial = try_hand(scene, suggested);
  EXPECT_FALSE(trial.starts_inside);
  EXPECT_TRUE(trial.touched_s.has_value());
}

TEST(SuggestedHand, OfEverySceneThatShipsStartsOutsideAndFeelsSomething) {
  std::istringstream names(SceneLibrary::shipped().names());
  int scenes = 0;
  for (std::string name; names >> name;) {
    if (name.ends_with(',')) name.pop_back();
    ++scenes;
    if (name != "free") expect_touches(load_scene(name));
  }
  EXPECT_GT(scenes, 30);
}

TEST(PlaceToBegin, IsOutsideInEverySceneThatShips) {
  std::istringstream names(SceneLibrary::shipped().names());
  for (std::string name; names >> name;) {
    if (name.ends_with(',')) name.pop_back();
    SCOPED_TRACE(name);
    const auto scene = load_scene(name);
    const control::Vector place_m = place_to_begin(*scene);
    ASSERT_GT(place_m.rows(), 0);
    scene::SceneState state(scene, static_cast<std::uint32_t>(place_m.rows()));
    const scene::Answer answer = state.answer(place_m, {}, {}, false, {});
    EXPECT_TRUE(answer.force.isZero(0) || answer.penetration_m <= 0) << "within an object that pushes";
  }
}

TEST(PlaceToBegin, IsTheAuthorsOrOutsideOfWhatIsAboutTheUsualPlace) {
  const std::string ball = "kind = 'sphere', center_m = [0, 0, 0], radius_m = 0.08";
  const control::Vector above_m = place_to_begin(*scene_with_object(ball));
  EXPECT_GT(above_m.norm(), 0.08);
  EXPECT_EQ(above_m.head(2), (control::Vector(2) << -0.02, 0).finished()) << "straight up";
  const control::Vector beside_m =
      place_to_begin(*scene_with_object("kind = 'sphere', center_m = [0], radius_m = 0.05", "1"));
  EXPECT_LT(beside_m[0], -0.05);
  EXPECT_EQ(place_to_begin(*scene_of("suggested_hand = 'press:from_m=-0.11'\n"))[0], -0.11);
}

TEST(SuggestedHand, FollowsWhereTheSurfaceIs) {
  const std::string sphere = "kind = 'sphere', radius_m = 0.01, center_m = ";
  EXPECT_EQ(suggested_hand(scene_with_object(sphere + "[0.02, -0.03, 0.04]")).hand,
            "stroke:offset_x_m=0.02,offset_y_m=-0.03,offset_z_m=0.05,depth_m=0.004,length_m=0.01");
  EXPECT_EQ(suggested_hand(scene_with_object("kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1]")).hand,
            "stroke");
  EXPECT_EQ(
      suggested_hand(scene_with_object("kind = 'half_space', through_m = [0.02, 0, 0], normal = [-1, 0, 0]")).hand,
      "press:from_m=0.01,to_m=0.03,stiffness_N_per_m=300");
  EXPECT_EQ(suggested_hand(scene_with_object("kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, -1]")).hand,
            "press:axis=2,from_m=-0.01,to_m=0.01,stiffness_N_per_m=300")
      << "a ceiling";
}

TEST(SuggestedHand, IsOneThatTouchesWhateverTheShapeAndAxes) {
  for (const char* const shape :
       {"kind = 'box', center_m = [0.01, 0.02, 0.03], size_m = [0.02, 0.1, 0.005]",
        "kind = 'cavity', center_m = [0.01, 0, 0], radius_m = 0.05",
        "kind = 'torus', center_m = [0, 0, 0.02], axis = [1, 1, 1], major_radius_m = 0.03, minor_radius_m = 0.004",
        "kind = 'cylinder', from_m = [-0.05, 0.01, 0], to_m = [0.05, 0.01, 0.02], radius_m = 0.008",
        "kind = 'capsule', from_m = [0, 0, -0.08], to_m = [0, 0, -0.02], radius_m = 0.02",
        "kind = 'height_field', origin_m = [0, 0, 0], spacing_m = 0.02, heights_m = [[0, 0.01], [0.02, 0]]"}) {
    SCOPED_TRACE(shape);
    expect_touches(scene_with_object(shape));
  }
  expect_touches(scene_with_object("kind = 'cavity', center_m = [0.01, 0], radius_m = 0.03", "2"));
  expect_touches(scene_with_object("kind = 'sphere', center_m = [0.05, 0], radius_m = 0.02", "2"));
  expect_touches(scene_with_object("kind = 'half_space', through_m = [-0.03], normal = [1]", "'any'"));
  expect_touches(scene_with_object("kind = 'sphere', center_m = [0.06], radius_m = 0.01", "1"));
}

TEST(SuggestedHand, OfAMeshIsOverItsTop) {
  const auto file = recorded_data("meshes/spot.obj");
  if (!file) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  const auto scene = scene_with_object("kind = 'mesh', file = '" + file->string() +
                                           "', scale = 0.05, rotation_deg = [90, 0, 0], offset_m = [0.02, 0, 0.01]",
                                       "3", file->parent_path().string() + "/");
  EXPECT_THAT(suggested_hand(scene).hand, StartsWith("stroke:offset_x_m=0.0"));
  expect_touches(scene);
}

TEST(SuggestedHand, WithoutASurfaceWavesAndFeelsAField) {
  const auto scene =
      scene_of("[[field]]\nname = 'f'\neffects = ['viscosity']\nviscosity = { damping_N_s_per_m = 1 }\n");
  EXPECT_EQ(to_options(suggested_hand(scene)), "--device omni --operator wave");
  EXPECT_TRUE(try_hand(scene, suggested_hand(scene)).touched_s);
  EXPECT_FALSE(try_hand(load_scene("free"), suggested_hand(load_scene("free"))).touched_s);
}

TEST(SuggestedHand, IsOneThatCanBeSimulatedHoweverFarTheSurface) {
  const auto scene = scene_with_object(
      "kind = 'height_field', origin_m = [0, 0, 0], spacing_m = 0.02, heights_m = [[1e308, 1e308], [1e308, 1e308]]");
  const SuggestedHand suggested = suggested_hand(scene);
  EXPECT_NO_THROW((void)try_hand(scene, suggested)) << to_options(suggested);
}

TEST(SuggestedHand, IsTheAuthorsIfGiven) {
  const SuggestedHand given =
      suggested_hand(scene_of("suggested_device = 'cartesian-3dof'\nsuggested_hand = 'stroke:offset_z_m=0.01'\n"));
  EXPECT_EQ(to_options(given), "--device cartesian-3dof --operator stroke:offset_z_m=0.01");
  EXPECT_FALSE(given.computed);
  EXPECT_EQ(to_options(suggested_hand(scene_of("suggested_device = 'cartesian-3dof'\n"))),
            "--device cartesian-3dof --operator wave");
}

TEST(SuggestedHand, UnknownHandIsRefusedWithFileAndLine) {
  EXPECT_THAT(refusal_of("suggested_hand = 'strok'\n"),
              StartsWith("s.toml:5: scene: suggested_hand: unknown operator 'strok', did you mean 'stroke'? (known: "));
  EXPECT_THAT(refusal_of("suggested_hand = 'stroke:offset_m=1'\n"),
              StartsWith("s.toml:5: scene: suggested_hand: operator 'stroke': unknown key 'offset_m'"));
  EXPECT_THAT(refusal_of("suggested_hand = 'press:to_m=inf'\n"), HasSubstr("to_m must be a finite number, got 'inf'"));
  EXPECT_THAT(refusal_of("suggested_hand = 7\n"), StartsWith("s.toml:5: scene: suggested_hand must be text, got 7"));
  EXPECT_THAT(refusal_of("suggested_hand = 'stroke'\n", "1"), HasSubstr("needs 3 degrees of freedom, has 1"));
  EXPECT_THAT(refusal_of("suggested_hand = 'replay:/etc/passwd'\n"), HasSubstr("a recorded hand lies with the client"));
  EXPECT_THAT(refusal_of("suggested_device = 'omny'\n"),
              StartsWith("s.toml:5: scene: suggested_device: no device 'omny' ships, did you mean 'omni'?"));
  EXPECT_THAT(refusal_of("suggested_device = '/tmp/mine.toml'\n"), HasSubstr("no device '/tmp/mine.toml' ships"));
  EXPECT_EQ(refusal_of("suggested_device = 'wall-1dof'\n"),
            "s.toml:5: scene: suggested_device: this scene accepts 3 or 6 degrees of freedom, 'wall-1dof' has 1");
}

TEST(TryHand, WithinAnObjectThatDoesNotPushStartsNowhere) {
  const auto scene = scene_of(
      "[[object]]\nname = 'fog'\neffects = ['viscosity']\nviscosity = { damping_N_s_per_m = 3 }\n"
      "shape = { kind = 'sphere', center_m = [0, 0, 0], radius_m = 0.03 }\n");
  const HandTrial trial = try_hand(scene, {.device = "omni", .hand = "wave"});
  EXPECT_FALSE(trial.starts_inside);
  EXPECT_GT(trial.touched_s.value_or(0), 0) << "it drags as soon as the hand moves";
}

TEST(TryHand, DistinguishesAStartInsideFromATouch) {
  const auto scene = scene_with_object("kind = 'sphere', center_m = [0, 0, 0], radius_m = 0.03");
  EXPECT_TRUE(try_hand(scene, {.device = "omni", .hand = "wave"}).starts_inside);
  const HandTrial above = try_hand(scene, {.device = "omni", .hand = "stroke:offset_z_m=0.03"});
  EXPECT_FALSE(above.starts_inside);
  EXPECT_GT(above.touched_s.value_or(0), 0.1);
  EXPECT_FALSE(try_hand(scene, {.device = "omni", .hand = "stroke:offset_z_m=0.2"}).touched_s);
  EXPECT_THROW((void)try_hand(scene, {.device = "omni", .hand = "nobodys"}), std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::server
