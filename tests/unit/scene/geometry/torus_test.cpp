#include "forcebound/scene/geometry/torus.hpp"

#include <cmath>

#include "tests/support/random_points.hpp"
#include "tests/support/shape_checks.hpp"

namespace forcebound::scene {
namespace {

using test::expect_surface;
using test::nearest;
using test::nearest_after;

/// Lying, R = 30 mm, r = 10 mm.
std::unique_ptr<Shape> torus() { return make_torus(Point::Zero(), {0, 0, 2}, 0.03, 0.01); }

TEST(Torus, PushesAwayFromItsCircle) {
  expect_surface(nearest(*torus(), {0.036, 0, 0}), {1, 0, 0}, 0.004, 1e-14);
  expect_surface(nearest(*torus(), {0.024, 0, 0}), {-1, 0, 0}, 0.004, 1e-14);
  expect_surface(nearest(*torus(), {0, 0.03, -0.007}), {0, 0, -1}, 0.003, 1e-14);
  expect_surface(nearest(*torus(), {0, 0.033, 0.004}), {0, 0.6, 0.8}, 0.005, 1e-13);
}

TEST(Torus, HasAHole) {
  const SurfacePoint found = nearest_after(*torus(), {0, 0, 0}, {0, 1, 0});
  EXPECT_NEAR(found.penetration_m, -0.02, 1e-15);
  EXPECT_TRUE(found.normal_is_old) << "all around is equally near";
  expect_surface(nearest(*torus(), {0, 0.005, 0}), {0, -1, 0}, -0.015, 1e-14);
}

TEST(Torus, IsADistanceInsideAndOutside) {
  ASSERT_TRUE(rc::check([] {
    const Point p = test::draw_point(0.06);
    const double across_m = p.head<2>().norm();
    RC_PRE(across_m > 1e-4);
    RC_PRE(std::hypot(across_m - 0.03, p.z()) > 1e-4);
    test::expect_distance_at(*torus(), p, 1e-7);
  }));
}

TEST(Torus, KeepsTheLastNormalOnItsCircleTurnedSquareToIt) {
  const SurfacePoint found = nearest_after(*torus(), {0.03, 0, 0}, {0, 0.6, 0.8});
  EXPECT_TRUE(found.normal_is_old);
  EXPECT_LT((found.normal - Point(0, 0, 1)).norm(), 1e-15);
  EXPECT_EQ(found.penetration_m, 0.01);
}

TEST(Torus, PushesSquareToItsCircleWhereNoNormalWasEverValid) {
  const SurfacePoint found = nearest(*torus(), {0, -0.03, 0});
  EXPECT_TRUE(found.normal_is_old);
  EXPECT_NEAR(found.normal.norm(), 1, 1e-15);
  EXPECT_EQ(found.normal.x(), 0);
}

}  // namespace
}  // namespace forcebound::scene
