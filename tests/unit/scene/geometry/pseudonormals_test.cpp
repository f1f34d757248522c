#include "forcebound/scene/geometry/pseudonormals.hpp"

#include <gmock/gmock.h>

#include <random>

#include "forcebound/server/environment/mesh_file.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/winding.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::scene {
namespace {

/// Random points about the mesh, half of them close to its vertices, where signs are most easily wrong.
void expect_the_side_that_the_solid_angle_says(const TriangleMesh& made, int points) {
  const auto mesh = std::make_shared<const TriangleMesh>(made);
  const Bvh bvh(mesh);
  const Pseudonormals sides(*mesh);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::uniform_int_distribution<std::size_t> any(0, mesh->vertices_m().size() - 1);
  int inside = 0;
  for (int i = 0; i < points; ++i) {
    const Point offset(unit(random), unit(random), unit(random));
    const Point p = i % 2 == 0 ? Point(mesh->box_m().max().cwiseProduct(offset))
                               : Point(mesh->vertices_m()[any(random)] + 0.02 * mesh->size_m() * offset);
    const bool is_inside = sides.is_inside(p, bvh.nearest(p).value());
    EXPECT_EQ(is_inside, test::winding(*mesh, p) > 0.5) << p.transpose();
    inside += is_inside ? 1 : 0;
  }
  EXPECT_GT(inside, points / 20);
  EXPECT_LT(inside, points);
}

TEST(Pseudonormals, TellInsideFromOutside) {
  expect_the_side_that_the_solid_angle_says(test::block({1, 2, 0.5}).moved(test::askew()).mesh(), 4000);
  expect_the_side_that_the_solid_angle_says(test::ball(1, 8).mesh(), 2000);
  // A long spike beside a block: normals of one face alone would call points beyond its tip inside.
  test::Soup spike{{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {2, 1, 3}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  expect_the_side_that_the_solid_angle_says(spike.add(test::block({0.5, 0.5, 1}).moved(test::askew({3, 0, 0}))).mesh(),
                                            4000);
}

TEST(Pseudonormals, TellInsideFromOutsideOfARealMesh) {
  const auto path = recorded_data("meshes/spot.obj");
  if (!path) GTEST_SKIP() << "no meshes/spot.obj in FORCEBOUND_DATA";
  expect_the_side_that_the_solid_angle_says(server::load_mesh(path->string()), 2000);
}

TEST(Pseudonormals, RefuseAMeshWithoutAnInside) {
  EXPECT_THAT([] { Pseudonormals{test::square(1, 1).mesh("sheet.stl")}; },
              testing::ThrowsMessage<GeometryError>("sheet.stl: has no inside, since it is not closed: 2 triangles, 4 "
                                                    "vertices, open; 4 open edges"));
}

}  // namespace
}  // namespace forcebound::scene
