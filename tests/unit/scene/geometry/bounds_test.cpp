#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "forcebound/scene/geometry/capsule.hpp"
#include "forcebound/scene/geometry/cylinder.hpp"
#include "forcebound/scene/geometry/distance_field.hpp"
#include "forcebound/scene/geometry/height_field.hpp"
#include "forcebound/scene/geometry/mesh_shape.hpp"
#include "forcebound/scene/geometry/torus.hpp"
#include "tests/support/meshes.hpp"

namespace forcebound::scene {
namespace {

/// Seen from far away along an axis, the nearest point of a surface is its last one in that direction.
void expect_as_seen_from_afar(const Shape& shape) {
  constexpr double kAfar_m = 1e5;
  constexpr double kTolerance_m = 1e-6;  // a width of 0.3 m seen from there, and the rounding of 1e5
  const Eigen::AlignedBox3d bounds_m = shape.facts().bounds_m;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      std::array<double, 3> state{};
      const Point from_m = bounds_m.center() + side * kAfar_m * Point::Unit(axis);
      const SurfacePoint nearest = shape.nearest(from_m, reinterpret_cast<std::byte*>(state.data()));  // NOLINT
      const Point last_m = from_m + nearest.penetration_m * nearest.normal;
      EXPECT_NEAR(last_m[axis], (side > 0 ? bounds_m.max() : bounds_m.min())[axis], kTolerance_m) << axis << side;
    }
  }
}

TEST(Bounds, OfAShapeAreWhereItsSurfaceEnds) {
  const Point oblique(1, -2, 2);
  const std::vector<std::shared_ptr<const Shape>> shapes{
      make_sphere({0.1, 0.2, -0.3}, 0.05), make_box({0.1, 0.2, -0.3}, {0.1, 0.2, 0.3}),
      make_capsule({0.1, 0, 0}, {0, 0.05, 0.2}, 0.02), make_cylinder({0.1, 0, 0}, {0, 0.05, 0.2}, 0.02),
      make_torus({0.1, 0.2, -0.3}, oblique, 0.05, 0.01)};
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    SCOPED_TRACE("shape " + std::to_string(i));
    expect_as_seen_from_afar(*shapes[i]);
  }
}

TEST(Bounds, OfAMeshAreThoseOfItsTrianglesInTheScene) {
  const auto mesh = std::make_shared<const TriangleMesh>(
      test::block({0.2, 0.1, 0.4}).mesh("block", {.scale = 0.5, .offset_m = {1, 2, 3}}));
  const Eigen::AlignedBox3d expected = mesh->box_m().translated(mesh->origin_m());
  EXPECT_LT((expected.sizes() - Point(0.2, 0.1, 0.4)).norm(), 1e-15) << "a block of twice that, halved";
  for (const auto& bounds_m : {make_mesh(mesh)->facts().bounds_m,
                               make_distance_field(mesh, {.spacing_m = 0.02, .reach_m = 0.01})->facts().bounds_m}) {
    EXPECT_TRUE(bounds_m.isApprox(expected));
  }
}

TEST(Bounds, OfAReliefAreThoseOfItsHeights) {
  const auto shape = make_height_field(
      {.origin_m = {0.1, 0.2, 0.3}, .spacing_m = 0.02, .columns = 3, .heights_m = {0, 0.01, 0, 0, -0.02, 0.005}});
  const Eigen::AlignedBox3d bounds_m = shape->facts().bounds_m;
  EXPECT_LT((bounds_m.min() - Point(0.1, 0.2, 0.28)).norm(), 1e-15);
  EXPECT_LT((bounds_m.max() - Point(0.14, 0.22, 0.31)).norm(), 1e-15);
}

TEST(Bounds, OfAnInfiniteShapeAreUnknown) {
  EXPECT_TRUE(make_half_space({0, 0, 0}, {0, 0, 1})->facts().bounds_m.isEmpty());
}

}  // namespace
}  // namespace forcebound::scene
