#include "forcebound/tissue/tissue_surface.hpp"

#include <gtest/gtest.h>

#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

TissueSurface block_surface() {
  const TetrahedralMesh mesh(test::tetrahedra_of({.cubes = {3, 3, 3}, .cube_m = 0.01}));
  return {mesh.nodes_m(), mesh.triangles()};
}

TEST(TissueSurface, FindsWhereAWayGoesIn) {
  const TissueSurface surface = block_surface();
  const auto from_above = surface.entry({0.0123, 0.0171, 0.05}, {0.0123, 0.0171, -0.05});
  ASSERT_TRUE(from_above);
  EXPECT_LT((surface.at(*from_above) - scene::Point(0.0123, 0.0171, 0.03)).norm(), 1e-15);
  const auto aslant = surface.entry({-0.01, 0.011, 0.013}, {0.02, 0.026, 0.016});
  ASSERT_TRUE(aslant);
  EXPECT_LT((surface.at(*aslant) - scene::Point(0, 0.016, 0.014)).norm(), 1e-15);
}

TEST(TissueSurface, FindsAWayInThroughEdgesAndCornersOfTriangles) {
  const TissueSurface surface = block_surface();
  for (int x = 0; x <= 6; ++x) {
    for (int y = 0; y <= 6; ++y) {
      const scene::Point at(0.005 * x, 0.005 * y, 0.03);
      const auto found = surface.entry(at + scene::Point(0, 0, 0.001), at - scene::Point(0, 0, 0.001));
      ASSERT_TRUE(found) << at.transpose();
      EXPECT_LT((surface.at(*found) - at).norm(), 1e-11);
      EXPECT_TRUE(surface.entry(at, at - scene::Point(0, 0, 0.001))) << "from the surface itself";
    }
  }
}

TEST(TissueSurface, AWayOutOrBesideOrTooShortGoesInNowhere) {
  const TissueSurface surface = block_surface();
  EXPECT_FALSE(surface.entry({0.015, 0.014, 0.02}, {0.015, 0.014, 0.05}));
  EXPECT_FALSE(surface.entry({0.031, 0.014, 0.05}, {0.031, 0.014, -0.05}));
  EXPECT_FALSE(surface.entry({0.015, 0.014, 0.05}, {0.015, 0.014, 0.031}));
  EXPECT_FALSE(surface.entry({0.015, 0.014, 0.05}, {0.015, 0.014, 0.05}));
}

TEST(TissueSurface, KnowsTheNearestPlaceAndOnWhichSideThePointIs) {
  const TissueSurface surface = block_surface();
  const auto inside = surface.nearest({0.015, 0.014, 0.027});
  EXPECT_NEAR(inside.height_m, -0.003, 1e-15);
  EXPECT_LT((surface.at(inside.place) - scene::Point(0.015, 0.014, 0.03)).norm(), 1e-15);
  const auto beside_a_corner = surface.nearest({0.031, 0.032, 0.033});
  EXPECT_NEAR(beside_a_corner.height_m, 0.003, 1e-15);
  EXPECT_LT((surface.at(beside_a_corner.place) - scene::Point(0.03, 0.03, 0.03)).norm(), 1e-15);
}

TEST(TissueSurface, KnowsWhatLiesBesideAndWhichWayIsOut) {
  const TissueSurface surface = block_surface();
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const int other = surface.beyond(t, corner);
      ASSERT_NE(other, TissueSurface::kNone);
      int back = 0;
      for (int c = 0; c < 3; ++c) back += surface.beyond(other, c) == t ? 1 : 0;
      EXPECT_EQ(back, 1);
      EXPECT_LE(surface.first_triangle(surface.triangles()[t][corner]), t);
    }
    const scene::Point middle = surface.at({.triangle = t, .weight = scene::Point::Constant(1.0 / 3)});
    EXPECT_GT(surface.triangle_normal(t).dot(middle - scene::Point::Constant(0.015)), 0.0149);
    EXPECT_GT(
        surface.normal_at({.triangle = t, .weight = scene::Point::Constant(1.0 / 3)}).dot(surface.triangle_normal(t)),
        0.6);
  }
  EXPECT_NEAR(surface.longest_edge_m(), 0.01 * std::sqrt(2.0), 1e-15);
}

TEST(TissueSurface, EndsWhereItIsOpen) {
  const TissueSurface surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  for (int corner = 0; corner < 3; ++corner) EXPECT_EQ(surface.beyond(0, corner), TissueSurface::kNone);
  EXPECT_EQ(surface.node_normal(1), scene::Point(0, 0, 1));
}

}  // namespace
}  // namespace forcebound::tissue
