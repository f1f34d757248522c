#include "forcebound/scene/geometry/distance_field.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>
#include <stop_token>

#include "forcebound/scene/geometry/bvh.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/shape_client.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::scene {
namespace {

using test::kNaN;
using test::ShapeClient;
using test::shared_mesh;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(DistanceField, IsExactOverAPlaneFace) {
  ShapeClient client(make_distance_field(shared_mesh(test::block({1, 1, 1}), {.offset_m = {10, 0, 0}}),
                                         {.spacing_m = 0.07, .reach_m = 0.2}));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    const double height_m = 0.2 * unit(random);
    const SurfacePoint found = client.at({10 + 0.5 * unit(random), 0.5 * unit(random), 1 + height_m});
    ASSERT_NEAR(found.penetration_m, -height_m, 1e-12);
    ASSERT_LT((found.normal - Point::UnitZ()).norm(), 1e-12);
  }
}

TEST(DistanceField, IsThatOfABallToTheSquareOfTheSpacing) {
  constexpr double kSpacing_m = 0.1;
  ShapeClient client(make_distance_field(shared_mesh(test::ball(1, 40)), {.spacing_m = kSpacing_m, .reach_m = 0.3}));
  const double facets_m = 1 - std::cos(std::numbers::pi / 40);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Point out = Point(unit(random), unit(random), unit(random)).normalized();
    const double radius_m = 0.9 + 0.3 * unit(random);
    const SurfacePoint found = client.at(radius_m * out);
    ASSERT_NEAR(found.penetration_m, 1 - radius_m, facets_m + 0.5 * kSpacing_m * kSpacing_m);
    ASSERT_GT(found.normal.dot(out), std::cos(0.08));
    ASSERT_NEAR(found.normal.norm(), 1, 1e-12);
  }
}

TEST(DistanceField, HasNoBumpsBetweenItsCells) {
  constexpr double kSpacing_m = 0.1;
  ShapeClient client(make_distance_field(shared_mesh(test::ball(1, 60)), {.spacing_m = kSpacing_m}));
  Point before = client.at({0.8, 0, 0.01}).normal;
  for (int i = 1; i < 20000; ++i) {
    const SurfacePoint found = client.at({0.8 * std::cos(1e-4 * i), 0.8 * std::sin(1e-4 * i), 0.01});
    ASSERT_LT((found.normal - before).norm(), 5e-4) << i;
    before = found.normal;
  }
}

TEST(DistanceField, KeepsTheLastNormalInTheVeryMiddle) {
  // An odd number of steps from side to side, so that the middle of the ball is the middle of a cell.
  ShapeClient client(make_distance_field(shared_mesh(test::block({1, 1, 1})), {.spacing_m = 2.0 / 21}));
  const SurfacePoint before = client.at({0.3, 0.1, 0});
  EXPECT_FALSE(before.normal_is_old);
  const SurfacePoint middle = client.at({0, 0, 0});
  EXPECT_TRUE(middle.normal_is_old);
  EXPECT_EQ(middle.normal, before.normal);
  EXPECT_NEAR(middle.penetration_m, 1, 0.1);
}

TEST(DistanceField, HasNoContactOutsideOfItsGridNorWithoutAPlace) {
  ShapeClient client(make_distance_field(shared_mesh(test::block({1, 1, 1})), {.spacing_m = 0.25, .reach_m = 0.5}));
  EXPECT_NEAR(client.at({0, 0, 1.5}).penetration_m, -0.5, 1e-12);
  for (const double bad : {5.0, -5.0, 1e300, -1e300, kNaN, std::numeric_limits<double>::infinity()}) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      Point p(0, 0, 0);
      p[axis] = bad;
      EXPECT_EQ(client.at(p).penetration_m, -0.5) << bad;
      EXPECT_TRUE(client.at(p).normal.allFinite());
    }
  }
  EXPECT_GT(client.at({0, 0, 0.9}).penetration_m, 0);
}

TEST(DistanceField, RefusesWhatHasNoInsideAndWhatDoesNotFit) {
  const auto refused = [](const test::Soup& soup, const DistanceFieldOptions& options) {
    return [=] { (void)make_distance_field(shared_mesh(soup), options); };
  };
  const auto block = test::block({1, 1, 1});
  EXPECT_THAT(refused(test::square(1, 2), {.spacing_m = 0.1}),
              ThrowsMessage<GeometryError>(HasSubstr("test.obj: has no inside, since it is not closed")));
  EXPECT_THAT(refused(block.inside_out(), {.spacing_m = 0.1}),
              ThrowsMessage<GeometryError>(HasSubstr("is inside out")));
  EXPECT_THAT(refused(block, {.spacing_m = 0}),
              ThrowsMessage<GeometryError>(HasSubstr("spacing_m must be > 0, got 0")));
  EXPECT_THAT(refused(block, {.spacing_m = kNaN}), ThrowsMessage<GeometryError>(HasSubstr("spacing_m must be > 0")));
  EXPECT_THAT(refused(block, {.spacing_m = 1, .reach_m = -1}), ThrowsMessage<GeometryError>(HasSubstr("reach_m")));
  EXPECT_THAT(refused(block, {.spacing_m = 1e-3}),
              ThrowsMessage<GeometryError>(HasSubstr("grid nodes, more than 4194304")));
  EXPECT_THAT(refused(block, {.spacing_m = 1e-300}), ThrowsMessage<GeometryError>(HasSubstr("grid nodes")));
}

TEST(DistanceField, IsGivenUpWhereNobodyWaitsForItAnyMore) {
  const auto mesh = shared_mesh(test::ball(0.03, 20));
  const DistanceFieldOptions options{.spacing_m = 0.002};
  std::stop_source end;
  const std::stop_token ended = end.get_token();
  const SearchBudget budget(std::numeric_limits<std::uint64_t>::max(), &ended);
  EXPECT_TRUE(make_distance_field(mesh, options));
  end.request_stop();
  EXPECT_THROW((void)make_distance_field(mesh, options), GeometryError);
}

TEST(DistanceField, NearestDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  ShapeClient client(make_distance_field(shared_mesh(test::block({1, 1, 1})), {.spacing_m = 0.25}));
  const test::AllocationGuard guard;
  EXPECT_GT(client.at({0.1, 0.2, 0.9}).penetration_m, 0);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::scene
