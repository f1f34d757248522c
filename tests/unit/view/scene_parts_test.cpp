#include "forcebound/view/scene_parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/scene_library.hpp"

namespace forcebound::view {
namespace {

using record::ScenePart;
using Kind = ScenePart::Kind;

std::vector<ScenePart> parts_of_shape(const std::string& shape) {
  return parts_of(ShownScene{.name = "test", .shapes = shape});
}

TEST(SceneParts, OfAHalfSpaceIsAPlaneWhoseOwnZIsTheNormal) {
  const auto parts = parts_of_shape(R"({"name":"floor","kind":"half_space","through_m":[0,0.1],"normal":[0,2]})");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].name, "floor");
  EXPECT_EQ(parts[0].kind, Kind::plane);
  EXPECT_FALSE(parts[0].moves);
  EXPECT_EQ(parts[0].place_m, Eigen::Vector3d(0, 0.1, 0));
  EXPECT_LT((parts[0].turn * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST(SceneParts, OfBallsHaveTheirDiameters) {
  const auto parts = parts_of_shape(R"({"name":"a","kind":"sphere","center_m":[1,2,3],"radius_m":0.5,"moves":true},)"
                                    R"({"name":"b","kind":"cavity","center_m":[0],"radius_m":0.25})");
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].kind, Kind::sphere);
  EXPECT_TRUE(parts[0].moves);
  EXPECT_EQ(parts[0].place_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(parts[0].size_m, Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(parts[1].kind, Kind::cavity);
  EXPECT_EQ(parts[1].size_m, Eigen::Vector3d(0.5, 0.5, 0.5));
}

TEST(SceneParts, OfABlockAreEndlessWhereItHasNoEnd) {
  const auto parts = parts_of_shape(R"({"name":"block","kind":"box","center_m":[0,0,0],"size_m":[0.1,null]})");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].kind, Kind::box);
  EXPECT_EQ(parts[0].size_m.x(), 0.1);
  EXPECT_TRUE(std::isinf(parts[0].size_m.y()));
  EXPECT_TRUE(std::isinf(parts[0].size_m.z()));
}

TEST(SceneParts, OfARodLieAlongIt) {
  const auto parts =
      parts_of_shape(R"({"name":"rod","kind":"capsule","from_m":[0,0,0],"to_m":[0.4,0,0],"radius_m":0.01})");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].kind, Kind::capsule);
  EXPECT_EQ(parts[0].place_m, Eigen::Vector3d(0.2, 0, 0));
  EXPECT_EQ(parts[0].size_m, Eigen::Vector3d(0.02, 0.02, 0.4));
  EXPECT_LT((parts[0].turn * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST(SceneParts, OfATorusAreAMeshOnIt) {
  const auto parts = parts_of_shape(
      R"({"name":"ring","kind":"torus","center_m":[0,0,1],"axis":[1,0,0],"major_radius_m":0.1,"minor_radius_m":0.02})");
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].kind, Kind::mesh);
  EXPECT_EQ(parts[0].triangles.size(), 2U * 48U * 16U);
  for (const Eigen::Vector3d& vertex : parts[0].vertices_m) {
    const Eigen::Vector3d from = vertex - Eigen::Vector3d(0, 0, 1);
    const double out_m = std::hypot(from.y(), from.z()) - 0.1;
    EXPECT_NEAR(std::hypot(out_m, from.x()), 0.02, 1e-12);
  }
}

TEST(SceneParts, LeaveOutWhatLacksItsNumbers) {
  for (const char* const shape :
       {R"({"name":"a","kind":"sphere","center_m":[0,0,0]})", R"({"name":"a","kind":"sphere","radius_m":1})",
        R"({"name":"a","kind":"sphere","center_m":[0,0,0],"radius_m":-1})",
        R"({"name":"a","kind":"sphere","center_m":[0,0,0],"radius_m":"1"})",
        R"({"name":"a","kind":"sphere","center_m":[0,0,0,0],"radius_m":1})",
        R"({"name":"a","kind":"half_space","through_m":[0,0,0],"normal":[0,0,0]})",
        R"({"name":"a","kind":"capsule","from_m":[0],"to_m":[0],"radius_m":1})", R"({"name":"a","kind":"new"})", "3",
        "nonsense"}) {
    EXPECT_TRUE(parts_of_shape(shape).empty()) << shape;
  }
  const ShownScene mesh{.name = "m", .meshes = R"({"name":"a","vertices_m":[0,0,0],"triangles":[0,0,1]})"};
  EXPECT_TRUE(parts_of(mesh).empty());
}

TEST(SceneParts, OfEveryShippedSceneAreAllThatItsPageDraws) {
  const server::SceneLibrary library = server::SceneLibrary::shipped();
  int parts_in_all = 0;
  for (const std::string& name : library.all_names()) {
    SCOPED_TRACE(name);
    const auto scene = library.find(name);
    ASSERT_NE(scene, nullptr);
    const auto parts = parts_of(shown(*scene, Which::all));
    EXPECT_EQ(parts.size(), scene->objects().size());
    parts_in_all += static_cast<int>(parts.size());
  }
  EXPECT_GE(parts_in_all, 4);
}

}  // namespace
}  // namespace forcebound::view
