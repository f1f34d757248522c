#include "forcebound/server/environment/scene_environment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/auto_scene.hpp"

namespace forcebound::server {
namespace {

std::shared_ptr<const scene::Scene> wall(double stiffness_N_per_m) {
  return parse_scene(
      "[scene]\nname = \"wall\"\ndescription = \"\"\ndegrees_of_freedom = 1\n"
      "[[object]]\nname = \"wall\"\n"
      "shape = { kind = \"half_space\", through_m = [0], normal = [-1] }\neffects = [\"surface\"]\n"
      "[object.surface]\nstiffness_N_per_m = " +
          std::to_string(stiffness_N_per_m) + "\n",
      "wall.toml");
}

double force_N(const EnvironmentKind& kind, double x_m) {
  const MadeEnvironment made = kind.make({.degrees_of_freedom = 1});
  const Vector position = Vector::Constant(1, x_m);
  return made.environment->respond({.position = position}).force[0];
}

TEST(SceneLibrary, MakesASceneAnEnvironmentWithTheScenesFacts) {
  const EnvironmentLibrary environments = SceneLibrary::shipped();
  const auto sphere = environments.find("sphere");
  ASSERT_NE(sphere, nullptr);
  EXPECT_EQ(sphere->name, "sphere");
  EXPECT_EQ(sphere->accepted_degrees_of_freedom(), "3 or 6");
  EXPECT_TRUE(sphere->accepts(6));
  EXPECT_FALSE(sphere->accepts(1));
  EXPECT_EQ(sphere->sessions_max, 0U);
  EXPECT_EQ(sphere->make({.degrees_of_freedom = 3}).hash, load_scene("sphere")->facts().hash);
  EXPECT_EQ(environments.find("spher"), nullptr);
}

TEST(SceneLibrary, AnEnvironmentThatIsAddedReplacesAScene) {
  EnvironmentLibrary environments = SceneLibrary::shipped();
  environments.add(scene_environment(wall(300)));
  EXPECT_NEAR(force_N(*environments.find("wall"), 0.01), -3, 1e-12);
  environments.add(scene_environment(wall(400)));
  EXPECT_NEAR(force_N(*environments.request("wall").found, 0.01), -4, 1e-12) << "the later one replaces it";
}

TEST(EnvironmentKind, OfAnAutoSceneIsFinerForAClientThatRendersLocally) {
  const EnvironmentKind kind = scene_environment(test::auto_wall());
  ClientFacts far{.degrees_of_freedom = 1, .round_trip = std::chrono::milliseconds(20)};
  EXPECT_THAT(kind.make(far).choice, testing::HasSubstr("stiffness_N_per_m = 100 for a round trip of 20 ms"));
  far.renders_locally = true;
  EXPECT_THAT(kind.make(far).choice, testing::HasSubstr("stiffness_N_per_m = 200 for a round trip of 20 ms and local"));
}

}  // namespace
}  // namespace forcebound::server
