#include "forcebound/tissue/tetrahedral_mesh.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <limits>
#include <stdexcept>

#include "tests/support/tissue_block.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::tissue {
namespace {

using test::BlockOfCubes;
using test::tetrahedra_of;

TetrahedralSoup one_tetrahedron() {
  return {.name = "one.msh",
          .nodes = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}},
          .tetrahedra = {{.nodes = {0, 1, 2, 3}, .line = 14}}};
}

std::string refusal(const TetrahedralSoup& soup, double scale_m = 1) {
  try {
    static_cast<void>(TetrahedralMesh(soup, {.scale = scale_m}));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

// Half the sum of the surface's areas times their outward normals' reach: the volume inside (Gauss).
double volume_within(const TetrahedralMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles()) {
    sum += mesh.nodes_m()[a].cross(mesh.nodes_m()[b]).dot(mesh.nodes_m()[c]);
  }
  return sum / 6;
}

TEST(TetrahedralMesh, ScalesNodesToMetres) {
  const TetrahedralMesh mesh(one_tetrahedron(), {.scale = 0.01});
  EXPECT_EQ(mesh.nodes_m()[1], scene::Point(0.02, 0, 0));
  EXPECT_NEAR(mesh.volume_m3(), 8e-6 / 6, 1e-20);
  EXPECT_NEAR(mesh.mean_edge_m(), (6 * 0.02 + 6 * 0.02 * std::sqrt(2.0)) / 12, 1e-15);
}

TEST(TetrahedralMesh, SurfaceOfABlockIsClosedAndFacesOutward) {
  const TetrahedralMesh mesh(tetrahedra_of({.cubes = {3, 2, 4}, .cube_m = 0.5, .from_m = {1, 2, 3}}));
  EXPECT_EQ(mesh.triangles().size(), 2 * 2 * (3 * 2 + 2 * 4 + 3 * 4));
  EXPECT_EQ(mesh.surface_nodes().size(), 4 * 3 * 5 - 2 * 1 * 3);
  EXPECT_NEAR(mesh.volume_m3(), 3, 1e-14);
  EXPECT_NEAR(volume_within(mesh), 3, 1e-13);
}

TEST(TetrahedralMesh, WithMiddlesHasANodeInEachEdgeAndFourTrianglesForEach) {
  TetrahedralSoup soup = tetrahedra_of({.cubes = {3, 2, 4}, .cube_m = 0.5, .from_m = {1, 2, 3}});
  soup.boxes.clear();
  const TetrahedralMesh mesh(soup);
  const TetrahedralMesh finer = mesh.with_middles();
  EXPECT_EQ(finer.nodes_m().size(), 7 * 5 * 9) << "along edges, and across sides and cubes";
  EXPECT_EQ(finer.triangles().size(), 4 * mesh.triangles().size());
  EXPECT_EQ(finer.surface_nodes().size(), 7 * 5 * 9 - 5 * 3 * 7);
  EXPECT_NEAR(volume_within(finer), 3, 1e-13);
  EXPECT_EQ(finer.tetrahedra(), mesh.tetrahedra());
  for (std::size_t t = 0; t < finer.tetrahedra().size(); ++t) {
    for (std::size_t e = 0; e < TetrahedralMesh::kEdges.size(); ++e) {
      const auto end_m = [&](std::size_t end) {
        return finer.nodes_m()[finer.tetrahedra()[t][TetrahedralMesh::kEdges[e][end]]];
      };
      EXPECT_LT((finer.nodes_m()[finer.middles()[t][e]] - 0.5 * (end_m(0) + end_m(1))).norm(), 1e-15);
    }
  }
}

TEST(TetrahedralMesh, OfABlockKnowsItsBoxes) {
  const TetrahedralMesh mesh(tetrahedra_of({.cubes = {3, 2, 4}, .cube_m = 0.5, .from_m = {1, 2, 3}}));
  ASSERT_EQ(mesh.boxes().size(), 3 * 2 * 4);
  for (const TetrahedralMesh::Box& box : mesh.boxes()) {
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const auto along_m = [&](std::size_t bit) { return (corner & bit) != 0 ? 0.5 : 0; };
      const scene::Point expected_m(along_m(1), along_m(2), along_m(4));
      EXPECT_LT((mesh.nodes_m()[box[corner]] - mesh.nodes_m()[box[0]] - expected_m).norm(), 1e-15);
    }
  }
}

TEST(TetrahedralMesh, TurnsAnInvertedTetrahedron) {
  TetrahedralSoup soup = one_tetrahedron();
  std::swap(soup.tetrahedra[0].nodes[0], soup.tetrahedra[0].nodes[1]);
  const TetrahedralMesh mesh(soup);
  EXPECT_NEAR(volume_within(mesh), 8.0 / 6, 1e-15);
}

TEST(TetrahedralMesh, LeavesOutNodesThatNothingUses) {
  TetrahedralSoup soup = one_tetrahedron();
  soup.nodes.insert(soup.nodes.begin() + 2, scene::Point(7, 7, 7));
  soup.tetrahedra[0].nodes = {0, 1, 3, 4};
  const TetrahedralMesh mesh(soup);
  EXPECT_EQ(mesh.nodes_m().size(), 4U);
  EXPECT_EQ(mesh.nodes_m()[2], scene::Point(0, 2, 0));
}

TEST(TetrahedralMesh, RefusesAFlatTetrahedronByFileAndLine) {
  TetrahedralSoup soup = one_tetrahedron();
  soup.nodes[3] = {0.5, 0.5, 0};
  EXPECT_EQ(refusal(soup),
            "one.msh:14: tetrahedron 1 is flat: six times its volume over its longest edge's cube must be > 1e-06, "
            "got 0");
  soup.nodes[3] = {0.5, 0.5, 1e-6};
  EXPECT_THAT(refusal(soup), testing::StartsWith("one.msh:14: tetrahedron 1 is flat"));
  soup.nodes[3] = {0.5, 0.5, 1e-4};
  EXPECT_EQ(refusal(soup), "accepted");
  soup.nodes = std::vector<scene::Point>(4, scene::Point(1, 1, 1));
  EXPECT_THAT(refusal(soup), testing::StartsWith("one.msh:14: tetrahedron 1 is flat"));
}

TEST(TetrahedralMesh, RefusesInvalidNumbers) {
  TetrahedralSoup soup = one_tetrahedron();
  soup.nodes[2][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(soup), "one.msh:14: tetrahedron 1 has a node that is not finite");
  EXPECT_EQ(refusal(one_tetrahedron(), 0), "one.msh: the scale must be > 0, rotation and offset finite, got 0");
  EXPECT_EQ(refusal(one_tetrahedron(), std::numeric_limits<double>::infinity()),
            "one.msh: the scale must be > 0, rotation and offset finite, got inf");
  soup = one_tetrahedron();
  soup.tetrahedra[0].nodes[3] = 4;
  EXPECT_EQ(refusal(soup), "one.msh:14: tetrahedron 1 names node 4 of 4");
  soup.tetrahedra.clear();
  EXPECT_EQ(refusal(soup), "one.msh: expected at least one tetrahedron");
}

TEST(TetrahedralMesh, RefusesTetrahedraThatOverlapOrMeetByThrees) {
  TetrahedralSoup soup = one_tetrahedron();
  soup.nodes.emplace_back(0.5, 0.5, 1);
  soup.tetrahedra.push_back({.nodes = {0, 1, 2, 4}, .line = 15});
  EXPECT_EQ(refusal(soup),
            "one.msh:15: tetrahedron 2 overlaps tetrahedron 1: expected two at one triangle to lie on either side of "
            "it");
  soup.nodes[4] = {0.5, 0.5, -1};
  EXPECT_EQ(refusal(soup), "accepted");
  soup.nodes.emplace_back(0.5, 0.5, -2);
  soup.tetrahedra.push_back({.nodes = {0, 1, 2, 5}, .line = 16});
  EXPECT_EQ(refusal(soup), "one.msh:16: tetrahedron 3 is the third at one triangle: expected at most two");
}

TEST(TetrahedralMesh, FindsNodesByPlaneAndBox) {
  const BlockOfCubes block{.cubes = {2, 2, 2}, .cube_m = 0.01};
  const TetrahedralMesh mesh(tetrahedra_of(block));
  EXPECT_EQ(nodes_below(mesh, scene::Point::Zero(), {0, 0, 7}).size(), 9U);
  EXPECT_EQ(nodes_below(mesh, {0, 0, 0.01}, {0, 0, 1}).size(), 18U);
  const std::vector<int> corner = nodes_in_box(mesh, {0.02, 0.02, 0.02}, {0.01, 0.01, 0.01});
  ASSERT_EQ(corner.size(), 1U);
  EXPECT_EQ(corner[0], static_cast<int>(block.node({2, 2, 2})));
}

TEST(TetrahedralMesh, TakesTheLiver) {
  const auto path = recorded_data("meshes/liver.msh");
  if (!path) GTEST_SKIP() << "meshes/liver.msh is not there";
  const TetrahedralMesh mesh(load_gmsh(path->string()), {.scale = 0.01});
  EXPECT_EQ(mesh.tetrahedra().size(), 596U);
  EXPECT_NEAR(volume_within(mesh), mesh.volume_m3(), 1e-12 * mesh.volume_m3());
  EXPECT_GT(mesh.volume_m3(), 1e-5);
}

}  // namespace
}  // namespace forcebound::tissue
