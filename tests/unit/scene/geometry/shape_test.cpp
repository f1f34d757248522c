#include "forcebound/scene/geometry/shape.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <array>
#include <limits>

#include "tests/support/shape_checks.hpp"

namespace forcebound::scene {
namespace {

using test::expect_surface;

const Point kLast = Point(0, 0.6, 0.8);

/// What a client's session keeps of a shape, after a contact with the normal kLast.
struct Kept {
  std::array<double, 3> numbers{0, 0.6, 0.8};
  operator std::byte*() { return reinterpret_cast<std::byte*>(numbers.data()); }  // NOLINT: for the tests below
};

TEST(HalfSpace, FillsBelowItsPlane) {
  const auto shape = make_half_space({0, 0, 0.01}, {0, 0, 5});
  expect_surface(shape->nearest({3, -4, 0.008}, Kept()), {0, 0, 1}, 0.002);
  expect_surface(shape->nearest({3, -4, 0.013}, Kept()), {0, 0, 1}, -0.003);
}

TEST(HalfSpace, NormalMayBeOfAnyLength) {
  const auto tiny = make_half_space(Point::Zero(), {0, 3e-200, 4e-200});
  expect_surface(tiny->nearest({0, 0, -1}, Kept()), {0, 0.6, 0.8}, 0.8);
}

TEST(Sphere, PushesAwayFromItsCentre) {
  const auto shape = make_sphere({0.1, 0, 0}, 0.02);
  expect_surface(shape->nearest({0.1, 0, 0.015}, Kept()), {0, 0, 1}, 0.005);
  EXPECT_LT(shape->nearest({0.1, 0, 0.021}, Kept()).penetration_m, 0);
}

TEST(Sphere, KeepsTheLastNormalAtItsVeryCentre) {
  const auto shape = make_sphere({0.1, 0, 0}, 0.02);
  const SurfacePoint found = shape->nearest({0.1, 0, 0}, Kept());
  EXPECT_EQ(found.normal, kLast);
  EXPECT_EQ(found.penetration_m, 0.02);
  EXPECT_TRUE(found.normal_is_old);
}

TEST(Sphere, KeepsTheLastNormalWhereADirectionWouldBeRounding) {
  const auto shape = make_sphere(Point::Zero(), 0.02);
  EXPECT_TRUE(shape->nearest({1e-300, 0, 0}, Kept()).normal_is_old);
  EXPECT_TRUE(shape->nearest({std::numeric_limits<double>::denorm_min(), 0, 0}, Kept()).normal_is_old);
  EXPECT_FALSE(shape->nearest({1e-12, 0, 0}, Kept()).normal_is_old);
}

TEST(Sphere, GivesTheSameAnswerAtAnyScale) {
  ASSERT_TRUE(rc::check([] {
    const double scale = std::pow(10.0, *rc::gen::inRange(-6, 7));
    const Point p(*rc::gen::inRange(-15, 16), *rc::gen::inRange(-15, 16), *rc::gen::inRange(1, 16));
    const SurfacePoint unit = make_sphere(Point::Zero(), 20)->nearest(p, Kept());
    const SurfacePoint scaled = make_sphere(Point::Zero(), 20 * scale)->nearest(scale * p, Kept());
    RC_ASSERT((scaled.normal - unit.normal).norm() < 1e-12);
    RC_ASSERT(std::abs(scaled.penetration_m / scale - unit.penetration_m) < 1e-12 * 20);
  }));
}

TEST(Cavity, PushesBackInwards) {
  const auto shape = make_cavity({0, 0, 0}, 0.04);
  expect_surface(shape->nearest({0.03, 0.04, 0}, Kept()), {-0.6, -0.8, 0}, 0.01);
}

TEST(Cavity, IsEmptyInsideItsCentreIncluded) {
  const auto shape = make_cavity({0, 0, 0}, 0.04);
  EXPECT_LT(shape->nearest({0.01, 0, 0}, Kept()).penetration_m, 0);
  EXPECT_LT(shape->nearest({0, 0, 0}, Kept()).penetration_m, 0);
}

TEST(Box, PushesOutOfTheNearestFace) {
  const auto shape = make_box({1, 0, 0}, {0.06, 0.06, 0.04});
  expect_surface(shape->nearest({1.029, 0.001, 0.002}, Kept()), {1, 0, 0}, 0.001);
  expect_surface(shape->nearest({0.971, 0.001, 0.002}, Kept()), {-1, 0, 0}, 0.001);
  expect_surface(shape->nearest({1.001, -0.028, 0.002}, Kept()), {0, -1, 0}, 0.002);
  expect_surface(shape->nearest({1.001, 0.001, 0.017}, Kept()), {0, 0, 1}, 0.003);
}

TEST(Box, IsEmptyOutside) {
  const auto shape = make_box({0, 0, 0}, {2, 2, 2});
  EXPECT_LT(shape->nearest({1.5, 0, 0}, Kept()).penetration_m, 0);
  EXPECT_LT(shape->nearest({1.5, 1.5, 1.5}, Kept()).penetration_m, 0);
  EXPECT_LE(shape->nearest({1, 0, 0}, Kept()).penetration_m, 0);
}

TEST(Box, TakesTheFirstAxisAndItsPositiveSideWhereFacesTie) {
  const auto shape = make_box({0, 0, 0}, {2, 2, 2});
  expect_surface(shape->nearest({0, 0, 0}, Kept()), {1, 0, 0}, 1);
  expect_surface(shape->nearest({0.5, 0.5, 0.5}, Kept()), {1, 0, 0}, 0.5);
  expect_surface(shape->nearest({0, -0.5, 0.5}, Kept()), {0, -1, 0}, 0.5);
}

TEST(Box, AxisOfInfiniteSizeHasNoFaces) {
  const double infinite = std::numeric_limits<double>::infinity();
  const auto shape = make_box({0, 0, 0}, {2, 2, infinite});
  expect_surface(shape->nearest({0.2, 0.7, 1e6}, Kept()), {0, 1, 0}, 0.3);
}

}  // namespace
}  // namespace forcebound::scene
