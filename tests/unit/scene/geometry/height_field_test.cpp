#include "forcebound/scene/geometry/height_field.hpp"

#include <cmath>

#include "tests/support/random_points.hpp"
#include "tests/support/shape_checks.hpp"

namespace forcebound::scene {
namespace {

using test::expect_surface;
using test::nearest;

/// 5 x 4 heights, 10 mm apart, from [0.1, 0.2, 0.3] on, so 40 x 30 mm.
template <class Height>
std::unique_ptr<Shape> field(Height height_m) {
  HeightGrid grid{.origin_m = {0.1, 0.2, 0.3}, .spacing_m = 0.01, .columns = 5};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 5; ++column) grid.heights_m.push_back(height_m(0.01 * column, 0.01 * row));
  }
  return make_height_field(grid);
}

std::unique_ptr<Shape> flat() {
  return field([](double, double) { return 0.0; });
}

std::unique_ptr<Shape> tilted() {
  return field([](double x, double y) { return 0.5 * x - 0.25 * y; });
}

std::unique_ptr<Shape> hilly() {
  return field([](double x, double y) { return 0.004 * std::sin(200 * x) * std::cos(150 * y); });
}

SurfacePoint at(const Shape& shape, const Point& from_origin_m) {
  return nearest(shape, Point(0.1, 0.2, 0.3) + from_origin_m);
}

TEST(HeightField, FillsBelowItsHeights) {
  expect_surface(at(*flat(), {0.023, 0.017, -0.002}), {0, 0, 1}, 0.002);
  expect_surface(at(*flat(), {0.023, 0.017, 0.003}), {0, 0, 1}, -0.003);
}

TEST(HeightField, IsExactForPlanes) {
  const Point normal = Point(-0.5, 0.25, 1).normalized();
  for (const double depth_m : {0.001, -0.001, -0.1}) {
    const Point on_plane(0.017, 0.012, 0.5 * 0.017 - 0.25 * 0.012);
    // Straight down, so that the point lies above the same square whatever the depth.
    const Point below = on_plane - depth_m / normal.z() * Point::UnitZ();
    expect_surface(at(*tilted(), below), normal, depth_m, 1e-14);
  }
}

TEST(HeightField, GoesThroughItsHeights) {
  const auto height_m = [](double x, double y) { return 0.004 * std::sin(200 * x) * std::cos(150 * y); };
  for (const double x : {0.0, 0.01, 0.03, 0.04}) {
    for (const double y : {0.0, 0.02, 0.03}) {
      EXPECT_NEAR(at(*hilly(), {x, y, height_m(x, y)}).penetration_m, 0, 1e-16) << x << " " << y;
    }
  }
}

TEST(HeightField, IsBilinearBetween) {
  const auto shape = field([](double x, double y) { return 20 * x * y; });
  for (const auto& [x, y] : {std::pair{0.013, 0.017}, {0.005, 0.0299}, {0.04, 0.011}}) {
    EXPECT_NEAR(at(*shape, {x, y, 20 * x * y}).penetration_m, 0, 1e-15);
  }
}

TEST(HeightField, IsOfFirstOrderInDistanceTimesCurvature) {
  // A trough of radius 0.5 m seen from 1 mm above its bottom, a grid step away from it.
  const auto shape = field([](double x, double) { return (x - 0.02) * (x - 0.02); });
  const double x = 0.01;
  const double z = 1e-4 + 0.001;
  const double radius_m = 0.5;
  const double exact_m = radius_m - std::hypot(x - 0.02, radius_m - z);
  EXPECT_NEAR(at(*shape, {x, 0.015, z}).penetration_m, -exact_m, 0.001 * 0.001 / radius_m + 1e-6);
}

TEST(HeightField, EndsInACliffBeyondWhichThereIsNothing) {
  expect_surface(at(*flat(), {-0.002, 0.015, -0.1}), {-1, 0, 0}, -0.002, 1e-13);
  expect_surface(at(*flat(), {0.041, 0.015, -0.1}), {1, 0, 0}, -0.001, 1e-13);
  expect_surface(at(*flat(), {0.043, 0.015, 0.004}), {0.6, 0, 0.8}, -0.005, 1e-12);
  expect_surface(at(*flat(), {0.043, 0.034, -0.1}), {0.6, 0.8, 0}, -0.005, 1e-12);
}

TEST(HeightField, PushesOutOfItsCliffWhereThatIsNearest) {
  expect_surface(at(*flat(), {0.001, 0.015, -0.02}), {-1, 0, 0}, 0.001, 1e-13);
  expect_surface(at(*flat(), {0.039, 0.015, -0.02}), {1, 0, 0}, 0.001, 1e-13);
  expect_surface(at(*flat(), {0.02, 0.001, -0.02}), {0, -1, 0}, 0.001, 1e-13);
  expect_surface(at(*flat(), {0.02, 0.029, -0.02}), {0, 1, 0}, 0.001, 1e-13);
}

TEST(HeightField, PenetrationIsContinuousEverywhere) {
  const auto shape = hilly();
  ASSERT_TRUE(rc::check([&] {
    const Point p = Point(0.02, 0.015, 0) + test::draw_point(0.03);
    const Point step = 1e-9 * test::draw_point(1);
    const double jump_m = at(*shape, p + step).penetration_m - at(*shape, p).penetration_m;
    RC_ASSERT(std::abs(jump_m) < 20 * 1e-9);
  }));
}

TEST(HeightField, NormalIsContinuousAcrossItsSquaresNearTheSurface) {
  const auto shape = hilly();
  ASSERT_TRUE(rc::check([&] {
    const double y = *rc::gen::inRange(1, 3000) * 1e-5;
    const double across = *rc::gen::inRange(1, 4) * 0.01;
    const Point left = at(*shape, {across - 1e-9, y, 0.01}).normal;
    const Point right = at(*shape, {across + 1e-9, y, 0.01}).normal;
    RC_ASSERT((left - right).norm() < 1e-5);
  }));
}

TEST(HeightField, StatesItsMemory) {
  EXPECT_GE(flat()->facts().memory_bytes, 20 * 3 * sizeof(double));
  EXPECT_EQ(flat()->facts().state_bytes, 0U);
}

}  // namespace
}  // namespace forcebound::scene
