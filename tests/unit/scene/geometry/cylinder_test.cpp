#include "forcebound/scene/geometry/cylinder.hpp"

#include <cmath>

#include "tests/support/random_points.hpp"
#include "tests/support/shape_checks.hpp"

namespace forcebound::scene {
namespace {

using test::expect_surface;
using test::nearest;
using test::nearest_after;

/// Upright, from z = -40 mm to 40 mm, of radius 30 mm.
std::unique_ptr<Shape> cylinder() { return make_cylinder({0, 0, -0.04}, {0, 0, 0.04}, 0.03); }

TEST(Cylinder, PushesOutOfItsSide) {
  expect_surface(nearest(*cylinder(), {0.028, 0, 0.01}), {1, 0, 0}, 0.002);
  expect_surface(nearest(*cylinder(), {-0.0156, 0.0208, -0.01}), {-0.6, 0.8, 0}, 0.004, 1e-14);
}

TEST(Cylinder, PushesOutOfItsFlatEnds) {
  expect_surface(nearest(*cylinder(), {0.01, 0.01, 0.037}), {0, 0, 1}, 0.003);
  expect_surface(nearest(*cylinder(), {0.01, 0.01, -0.037}), {0, 0, -1}, 0.003);
}

TEST(Cylinder, IsAsFarAsItsEdgeOutsideOfIt) {
  expect_surface(nearest(*cylinder(), {0.033, 0, 0.044}), {0.6, 0, 0.8}, -0.005, 1e-13);
  expect_surface(nearest(*cylinder(), {0, 0, 0.05}), {0, 0, 1}, -0.01);
  expect_surface(nearest(*cylinder(), {0, 0.05, 0.01}), {0, 1, 0}, -0.02);
}

TEST(Cylinder, OnItsVeryEdgeIsAtTheSurface) {
  const SurfacePoint found = nearest(*cylinder(), {0.03, 0, 0.04});
  EXPECT_EQ(found.penetration_m, 0);
  EXPECT_NEAR(found.normal.norm(), 1, 1e-15);
}

TEST(Cylinder, TakesTheSideWhereSideAndEndTieAndTheEndAtItsTip) {
  const auto flat = make_cylinder({0, 0, -0.25}, {0, 0, 0.25}, 1);
  expect_surface(nearest(*flat, {0.875, 0, 0.125}), {1, 0, 0}, 0.125);
  expect_surface(nearest(*flat, {0.5, 0, 0}), {0, 0, 1}, 0.25);
}

TEST(Cylinder, IsADistanceInsideAndOutside) {
  ASSERT_TRUE(rc::check([] {
    const Point p = test::draw_point(0.06);
    const double side_m = 0.03 - p.head<2>().norm();
    const double end_m = 0.04 - std::abs(p.z());
    RC_PRE(p.head<2>().norm() > 1e-4 && std::abs(p.z()) > 1e-6);
    RC_PRE(std::abs(side_m - end_m) > 1e-6);
    test::expect_distance_at(*cylinder(), p, 1e-7);
  }));
}

TEST(Cylinder, KeepsTheLastNormalOfItsSideOnItsAxis) {
  const SurfacePoint found = nearest_after(*cylinder(), {0, 0, 0.005}, {0, -1, 0});
  EXPECT_TRUE(found.normal_is_old);
  EXPECT_EQ(found.normal, Point(0, -1, 0));
  EXPECT_EQ(found.penetration_m, 0.03);
}

TEST(Cylinder, NeedsNoOldNormalOnItsAxisNearAnEnd) {
  expect_surface(nearest(*cylinder(), {0, 0, 0.035}), {0, 0, 1}, 0.005, 1e-14);
}

TEST(Cylinder, OnTwoAxesIsARectangle) {
  const auto shape = make_cylinder({-0.02, 0, 0}, {0.02, 0, 0}, 0.01);
  expect_surface(nearest(*shape, {0.001, -0.008, 0}), {0, -1, 0}, 0.002);
  EXPECT_EQ(nearest(*shape, {0.001, 0, 0}).normal, Point(0, 1, 0));
}

}  // namespace
}  // namespace forcebound::scene
