#include "forcebound/scene/geometry/capsule.hpp"

#include "tests/support/random_points.hpp"
#include "tests/support/shape_checks.hpp"

namespace forcebound::scene {
namespace {

using test::expect_surface;
using test::nearest;
using test::nearest_after;

/// From x = -30 mm to 50 mm, 10 mm thick to either side.
std::unique_ptr<Shape> capsule() { return make_capsule({-0.03, 0, 0}, {0.05, 0, 0}, 0.01); }

TEST(Capsule, PushesOutOfItsSide) {
  expect_surface(nearest(*capsule(), {0.02, 0, 0.008}), {0, 0, 1}, 0.002);
  expect_surface(nearest(*capsule(), {0.02, -0.003, 0.004}), {0, -0.6, 0.8}, 0.005, 1e-14);
}

TEST(Capsule, HasRoundEnds) {
  expect_surface(nearest(*capsule(), {0.053, 0.004, 0}), {0.6, 0.8, 0}, 0.005, 1e-14);
  expect_surface(nearest(*capsule(), {-0.036, 0, 0.008}), {-0.6, 0, 0.8}, 0, 1e-14);
}

TEST(Capsule, IsEmptyOutside) {
  expect_surface(nearest(*capsule(), {0.02, 0.015, 0}), {0, 1, 0}, -0.005);
  expect_surface(nearest(*capsule(), {0.065, 0, 0}), {1, 0, 0}, -0.005, 1e-14);
}

TEST(Capsule, IsADistanceInsideAndOutside) {
  ASSERT_TRUE(rc::check([] {
    const Point p = test::draw_point(0.08);
    RC_PRE(p.tail<2>().norm() > 1e-4);
    test::expect_distance_at(*capsule(), p, 1e-7);
  }));
}

TEST(Capsule, KeepsTheLastNormalOnItsAxisTurnedSquareToIt) {
  const SurfacePoint found = nearest_after(*capsule(), {0.02, 0, 0}, {0.6, 0.8, 0});
  EXPECT_TRUE(found.normal_is_old);
  EXPECT_LT((found.normal - Point(0, 1, 0)).norm(), 1e-15);
  EXPECT_EQ(found.penetration_m, 0.01);
}

TEST(Capsule, PushesSquareToItsAxisWhereNoNormalWasEverValid) {
  const SurfacePoint found = nearest(*capsule(), {0.02, 0, 0});
  EXPECT_TRUE(found.normal_is_old);
  EXPECT_EQ(found.normal, Point(0, 1, 0)) << "in the plane of the first two axes, for scenes of two";
  const SurfacePoint upright = nearest_after(*make_capsule({0, 0, -1}, {0, 0, 1}, 0.1), {0, 0, 0.3}, {0, 0, 1});
  EXPECT_EQ(upright.normal, Point(1, 0, 0));
}

TEST(Capsule, RemembersTheWayOutBeforeTheAxis) {
  const auto shape = capsule();
  test::KeptNormal kept;
  (void)shape->nearest({0.02, 0, -0.001}, kept.bytes());
  EXPECT_EQ(shape->nearest({0.02, 0, 0}, kept.bytes()).normal, Point(0, 0, -1));
}

}  // namespace
}  // namespace forcebound::scene
