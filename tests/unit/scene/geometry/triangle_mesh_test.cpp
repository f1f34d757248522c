#include "forcebound/scene/geometry/triangle_mesh.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "tests/support/meshes.hpp"

namespace forcebound::scene {
namespace {

using test::Soup;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(TriangleMesh, KnowsAClosedMeshAndItsVolume) {
  const auto mesh = test::block({1, 2, 3}).mesh();
  EXPECT_TRUE(mesh.report().closed());
  EXPECT_EQ(mesh.report().triangles, 12U);
  EXPECT_EQ(mesh.report().vertices, 8U);
  EXPECT_NEAR(mesh.report().volume_m3, 48, 1e-12);
  EXPECT_LT(test::block({1, 2, 3}).inside_out().mesh().report().volume_m3, 0);
  const auto ball = test::ball(1, 20).mesh();
  EXPECT_TRUE(ball.report().closed()) << to_text(ball.report());
  EXPECT_EQ(ball.report().triangles, 4U * 20 * 19);
}

TEST(TriangleMesh, KeepsVerticesRoundTheMiddleOfTheirBox) {
  const auto mesh = test::block({1, 2, 3}).mesh("block", {.scale = 0.5, .offset_m = {10, 0, 0}});
  EXPECT_EQ(mesh.origin_m(), Point(10, 0, 0));
  EXPECT_EQ(mesh.box_m().max(), Point(0.5, 1, 1.5));
  EXPECT_NEAR(mesh.size_m(), 0.5 * std::sqrt(14), 1e-15);
}

TEST(TriangleMesh, HasNormalsThatPointOutside) {
  const auto mesh = test::ball(1, 12).mesh();
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    EXPECT_GT(mesh.normals()[i].dot(mesh.corner_m(i, 0)), 0.9);
    EXPECT_NEAR(mesh.normals()[i].norm(), 1, 1e-15);
  }
}

TEST(TriangleMesh, KnowsTheTriangleBeyondEachEdge) {
  const auto mesh = test::square(1, 1).mesh();
  // {0, 1, 3} and {0, 3, 2}: the diagonal is the last side of the one and the first of the other.
  EXPECT_EQ(mesh.neighbours()[0], (Triangle{TriangleMesh::kNone, TriangleMesh::kNone, 1}));
  EXPECT_EQ(mesh.neighbours()[1], (Triangle{0, TriangleMesh::kNone, TriangleMesh::kNone}));
  EXPECT_EQ(mesh.report().open_edges, 4U);
  EXPECT_FALSE(mesh.report().closed());
}

TEST(TriangleMesh, WeldsEqualVerticesAndDropsThoseOfNoTriangle) {
  Soup soup;
  for (const Triangle& t : test::block({1, 1, 1}).triangles) {
    Soup single{{}, {{0, 1, 2}}};
    for (const auto corner : t) single.vertices.push_back(test::block({1, 1, 1}).vertices[corner]);
    soup.add(single);
  }
  soup.vertices.emplace_back(100, 100, 100);
  const auto mesh = soup.mesh();
  EXPECT_TRUE(mesh.report().closed());
  EXPECT_EQ(mesh.report().vertices, 8U);
  EXPECT_EQ(mesh.report().welded_vertices, 28U);
  EXPECT_EQ(mesh.report().unreferenced_vertices, 1U);
  EXPECT_EQ(mesh.box_m().max(), Point(1, 1, 1)) << "a vertex of no triangle has no place in the box";
}

TEST(TriangleMesh, DropsTrianglesWithoutAnAreaAndStaysClosed) {
  Soup soup = test::block({1, 1, 1});
  // A T-junction: the edge from 0 to 1 gets a vertex in its middle on one side, and a flat triangle fills the gap.
  soup.vertices.emplace_back(0, -1, -1);
  soup.triangles[1] = {0, 3, 8};
  soup.triangles.push_back({8, 3, 1});
  soup.triangles.push_back({0, 8, 1});
  soup.triangles.push_back({2, 2, 5});
  const auto mesh = soup.mesh();
  EXPECT_EQ(mesh.report().slivers, 2U);
  EXPECT_EQ(mesh.report().triangles, 13U);
  EXPECT_TRUE(mesh.report().closed()) << to_text(mesh.report());
}

TEST(TriangleMesh, DropsTheSameTriangleButNotItsBack) {
  Soup soup = test::square(1, 1);
  soup.triangles.push_back({3, 0, 1});
  EXPECT_EQ(soup.mesh().report().duplicate_triangles, 1U);
  soup.triangles.back() = {0, 3, 1};
  EXPECT_EQ(soup.mesh().report().duplicate_triangles, 0U);
}

TEST(TriangleMesh, CountsEdgesThatNoSurfaceHas) {
  Soup fan = test::square(1, 1);
  fan.vertices.emplace_back(0, 0, 1);
  fan.triangles.push_back({0, 3, 4});
  EXPECT_EQ(fan.mesh().report().non_manifold_edges, 1U);
  Soup disagreeing = test::block({1, 1, 1});
  std::swap(disagreeing.triangles[0][1], disagreeing.triangles[0][2]);
  EXPECT_EQ(disagreeing.mesh().report().inconsistent_edges, 3U);
  EXPECT_FALSE(disagreeing.mesh().report().closed());
  EXPECT_EQ(disagreeing.mesh().neighbours()[0][0], TriangleMesh::kNone);
}

TEST(TriangleMesh, RefusesInvalidMeshes) {
  const auto refused = [](const Soup& soup, const MeshPlacement& placement = {}) {
    return [=] { (void)soup.mesh("it.obj", placement); };
  };
  Soup soup = test::square(1, 1);
  soup.vertices[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refused(soup), ThrowsMessage<GeometryError>("it.obj: vertex 2 is not finite"));
  soup = test::square(1, 1);
  soup.triangles[1][2] = 4;
  EXPECT_THAT(refused(soup), ThrowsMessage<GeometryError>("it.obj: triangle 1 has vertex 4, but there are 4"));
  EXPECT_THAT(refused({}), ThrowsMessage<GeometryError>("it.obj: no triangles"));
  EXPECT_THAT(refused({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}),
              ThrowsMessage<GeometryError>("it.obj: no triangles, but for 1 without an area"));
  EXPECT_THAT(refused(test::square(1, 1), {.scale = -1}), ThrowsMessage<GeometryError>(HasSubstr("got -1")));
  EXPECT_THAT(refused(test::square(1, 1), {.scale = 1e200}), ThrowsMessage<GeometryError>(HasSubstr("size")));
}

TEST(MeshReport, SaysInOneLineWhatTheMeshIs) {
  EXPECT_EQ(to_text(test::block({1, 1, 1}).mesh().report()), "12 triangles, 8 vertices, closed");
  EXPECT_EQ(to_text(test::block({1, 1, 1}).inside_out().mesh().report()),
            "12 triangles, 8 vertices, closed, inside out");
  EXPECT_EQ(to_text(test::square(1, 1).mesh().report()), "2 triangles, 4 vertices, open; 4 open edges");
}

}  // namespace
}  // namespace forcebound::scene
