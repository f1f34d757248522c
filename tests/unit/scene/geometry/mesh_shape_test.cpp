#include "forcebound/scene/geometry/mesh_shape.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/shape_checks.hpp"
#include "tests/support/shape_client.hpp"

namespace forcebound::scene {
namespace {

using test::expect_surface;
using test::ShapeClient;
using test::shared_mesh;

TEST(MeshShape, HoldsTheClientThatComesFromOutside) {
  ShapeClient client(make_mesh(shared_mesh(test::block({1, 1, 1}), {.scale = 0.1, .offset_m = {5, 0, 0}})));
  EXPECT_EQ(client.at({5, 0, 0.2}).penetration_m, 0);
  expect_surface(client.at({5.01, 0.02, -0.09}), {0, 0, 1}, 0.19, 1e-12);
  EXPECT_EQ(client.at({5.01, 0.02, 0.11}).penetration_m, 0);
}

TEST(MeshShape, KeepsTheStateOfEachClientApart) {
  const auto shape = make_mesh(shared_mesh(test::block({1, 1, 1})));
  ASSERT_EQ(shape->facts().state_bytes % sizeof(double), 0U);
  std::vector<double> above(shape->facts().state_bytes / sizeof(double));
  std::vector<double> below = above;
  const auto ask = [&](std::vector<double>& state, const Point& p) {
    return shape->nearest(p, reinterpret_cast<std::byte*>(state.data()));
  };
  (void)ask(above, {0, 0, 2});
  (void)ask(below, {0, 0, -2});
  expect_surface(ask(above, {0.1, 0.1, 0}), {0, 0, 1}, 1, 1e-12);
  expect_surface(ask(below, {0.1, 0.1, 0}), {0, 0, -1}, 1, 1e-12);
}

TEST(MeshShape, PutsAClientFoundInsideToTheNearestSurface) {
  ShapeClient client(make_mesh(shared_mesh(test::block({1, 1, 1}))));
  expect_surface(client.at({0.9, 0.2, 0.3}), {1, 0, 0}, 0.1, 1e-12);
  client.begin_again();
  EXPECT_EQ(client.at({1.1, 0.2, 0.3}).penetration_m, 0);
  ShapeClient cavity(make_mesh(shared_mesh(test::block({1, 1, 1}).inside_out())));
  expect_surface(cavity.at({1.5, 0.2, 0.3}), {-1, 0, 0}, 0.5, 1e-12);
  ShapeClient sheet(make_mesh(shared_mesh(test::square(1, 3))));
  EXPECT_EQ(sheet.at({0, 0, -0.1}).penetration_m, 0) << "an open mesh has no inside";
}

TEST(MeshShape, BeginsOutsideWhereItIsToldAndNotAtTheFirstPlace) {
  const auto shape = make_mesh(shared_mesh(test::block({1, 1, 1})));
  std::vector<double> state(shape->facts().state_bytes / sizeof(double));
  auto* const bytes = reinterpret_cast<std::byte*>(state.data());
  shape->begin_outside({0.1, 0.1, 1.2}, bytes);
  expect_surface(shape->nearest({0.1, 0.1, -0.9}, bytes), {0, 0, 1}, 1.9, 1e-12);
}

TEST(MeshShape, BeginsAtItsNearestSurfaceIfItIsToldAPlaceInside) {
  const auto shape = make_mesh(shared_mesh(test::block({1, 1, 1})));
  std::vector<double> state(shape->facts().state_bytes / sizeof(double));
  auto* const bytes = reinterpret_cast<std::byte*>(state.data());
  shape->begin_outside({0.9, 0.2, 0.3}, bytes);
  expect_surface(shape->nearest({0.8, 0.2, 0.3}, bytes), {1, 0, 0}, 0.2, 1e-12);
}

TEST(MeshShape, KnowsTheDistanceWithinItsReach) {
  ShapeClient client(make_mesh(shared_mesh(test::block({1, 1, 1})), {.reach_m = 0.5}));
  expect_surface(client.at({0.2, 0.3, 1.4}), {0, 0, 1}, -0.4, 1e-12);
  expect_surface(client.at({1.3, 0, 1.4}), {0.6, 0, 0.8}, -0.5, 1e-12);
  EXPECT_EQ(client.at({0.2, 0.3, 1.6}).penetration_m, -0.5);
  expect_surface(client.at({0.2, 0.3, 0.9}), {0, 0, 1}, 0.1, 1e-12);
  EXPECT_EQ(client.at({0.2, 0.3, 1}).penetration_m, 0);
}

TEST(MeshShape, RefusesAnInvalidReach) {
  const auto mesh = shared_mesh(test::block({1, 1, 1}));
  for (const double reach_m :
       {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT([&] { (void)make_mesh(mesh, {.reach_m = reach_m}); },
                testing::ThrowsMessage<GeometryError>(testing::StartsWith("test.obj: reach_m must be >= 0, got ")));
  }
}

TEST(MeshShape, SaysWhatItKeeps) {
  const ShapeFacts small = make_mesh(shared_mesh(test::block({1, 1, 1})))->facts();
  const ShapeFacts large = make_mesh(shared_mesh(test::ball(1, 50)))->facts();
  EXPECT_EQ(small.state_bytes, large.state_bytes);
  EXPECT_GT(large.memory_bytes, 4 * 50 * 49 * sizeof(Triangle));
  EXPECT_GT(large.cost_ns, small.cost_ns);
}

TEST(MeshShape, NearestDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  ShapeClient client(make_mesh(shared_mesh(test::ball(1, 30)), {.reach_m = 1}));
  const test::AllocationGuard guard;
  for (int i = 0; i < 100; ++i) (void)client.at({0.1, 0.2, 1.5 - 0.01 * i});
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::scene
