#include "forcebound/view/shown_scene.hpp"

#include <gtest/gtest.h>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <utility>

#include "forcebound/scene/part.hpp"

namespace forcebound::view {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

scene::Scene scene_of(const std::vector<scene::PartDescription>& objects,
                      const std::vector<scene::PartDescription>& fields = {}) {
  const scene::Registry registry = scene::Registry::standard();
  scene::SceneParts parts;
  for (const auto& object : objects) parts.objects.push_back(make_part(object, registry));
  for (const auto& field : fields) parts.fields.push_back(make_part(field, registry));
  scene::SceneFacts facts;
  facts.name = "test";
  return {std::move(facts), std::move(parts)};
}

scene::NamedValues surface() { return {.name = "surface", .values = {{"stiffness_N_per_m", 1000.0}}}; }

TEST(ShownScene, HasShapesWithAllTheirValues) {
  const scene::Scene scene =
      scene_of({{.name = "ball",
                 .shape = {{"sphere", {{"center_m", Eigen::Vector3d(0, 0.01, 0)}, {"radius_m", 0.02}}}},
                 .effects = {surface()}}});
  const Json message = Json::parse(scene_message(1, shown(scene, Which::all)));
  EXPECT_EQ(message["kind"], "scene");
  EXPECT_EQ(message["track"], 1);
  EXPECT_EQ(message["name"], "test");
  ASSERT_EQ(message["shapes"].size(), 1);
  EXPECT_EQ(message["shapes"][0]["kind"], "sphere");
  EXPECT_EQ(message["shapes"][0]["name"], "ball");
  EXPECT_EQ(message["shapes"][0]["radius_m"], 0.02);
  EXPECT_EQ(message["shapes"][0]["center_m"], Json({0, 0.01, 0}));
  EXPECT_EQ(message["meshes"].size(), 0);
  EXPECT_EQ(message["more"], "");
}

TEST(ShownScene, HasMeshesOfWhatIsMadeOfTriangles) {
  const scene::Scene scene =
      scene_of({{.name = "cone",
                 .shape = {{"lathe", {{"profile_m", config::Rows{{0, 0}, {0.02, 0}, {0, 0.03}}}, {"segments", 16.0}}}},
                 .effects = {surface()}}});
  const Json message = Json::parse(scene_message(0, shown(scene, Which::all)));
  ASSERT_EQ(message["meshes"].size(), 1);
  const Json& mesh = message["meshes"][0];
  EXPECT_EQ(mesh["name"], "cone");
  EXPECT_EQ(mesh["vertices_m"].size() % 3, 0);
  EXPECT_EQ(mesh["triangles"].size(), 3 * 32);
  double highest_m = 0;
  for (std::size_t i = 2; i < mesh["vertices_m"].size(); i += 3) {
    highest_m = std::max(highest_m, mesh["vertices_m"][i].get<double>());
  }
  EXPECT_NEAR(highest_m, 0.03, 1e-6);  // in the scene's frame, not the mesh's own
  for (const Json& corner : mesh["triangles"]) EXPECT_LT(corner.get<std::size_t>(), mesh["vertices_m"].size() / 3);
}

TEST(ShownScene, NamesWhatHasNoShape) {
  const scene::Scene scene = scene_of({}, {{.name = "oil", .effects = {{"viscosity", {{"damping_N_s_per_m", 2.0}}}}}});
  const Json message = Json::parse(scene_message(0, shown(scene, Which::all)));
  EXPECT_THAT(message["more"].get<std::string>(), HasSubstr("'oil' has no shape: viscosity"));
}

}  // namespace
}  // namespace forcebound::view
