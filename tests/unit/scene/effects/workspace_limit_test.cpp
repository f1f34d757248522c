#include "forcebound/scene/effects/workspace_limit.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/field_checks.hpp"
#include "tests/support/random_points.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::scene {
namespace {

using test::kInfinity;

struct Room {
  double radius_m = kInfinity;
  Point size_m = Point::Constant(kInfinity);
  double damping_N_s_per_m = 0;
};

/// Around [0.1, 0, 0], K = 500 N/m.
std::unique_ptr<Effect> limit(const Room& room) {
  return workspace_limit_effect().make({{"center_m", Point(0.1, 0, 0)},
                                        {"radius_m", room.radius_m},
                                        {"size_m", room.size_m},
                                        {"stiffness_N_per_m", 500.0},
                                        {"damping_N_s_per_m", room.damping_N_s_per_m}});
}

const Room kBall{.radius_m = 0.04};
const Room kBlock{.size_m = {0.06, 0.04, 0.02}};
const Room kBoth{.radius_m = 0.03, .size_m = {0.1, 0.04, kInfinity}};

TEST(WorkspaceLimit, HasNoForceInsideTheRegion) {
  for (const Room& room : {kBall, kBlock, kBoth}) {
    EXPECT_EQ(test::force_N(*limit(room), {.position_m = {0.1, 0, 0}}), Point(0, 0, 0));
    EXPECT_EQ(test::force_N(*limit(room), {.position_m = {0.12, 0.01, -0.005}}), Point(0, 0, 0));
  }
}

TEST(WorkspaceLimit, PushesBackIntoABall) {
  EXPECT_LT((test::force_N(*limit(kBall), {.position_m = {0.1, 0.03, 0.04}}) - Point(0, -3, -4)).norm(), 1e-12);
}

TEST(WorkspaceLimit, PushesBackIntoABlockFromItsFacesEdgesAndCorners) {
  const auto effect = limit(kBlock);
  EXPECT_LT((test::force_N(*effect, {.position_m = {0.14, 0.01, 0}}) - Point(-5, 0, 0)).norm(), 1e-12);
  EXPECT_LT((test::force_N(*effect, {.position_m = {0.06, -0.03, 0}}) - Point(5, 5, 0)).norm(), 1e-12);
  EXPECT_LT((test::force_N(*effect, {.position_m = {0.06, -0.03, 0.02}}) - Point(5, 5, -5)).norm(), 1e-12);
}

TEST(WorkspaceLimit, OfTwoShapesIsTheirIntersection) {
  const auto effect = limit(kBoth);
  EXPECT_LT((test::force_N(*effect, {.position_m = {0.14, 0, 0}}) - Point(-5, 0, 0)).norm(), 1e-12) << "the ball";
  EXPECT_LT((test::force_N(*effect, {.position_m = {0.1, 0.025, 0}}) - Point(0, -2.5, 0)).norm(), 1e-12) << "the block";
}

TEST(WorkspaceLimit, ResistsLeavingAndNeverResistsReturning) {
  const auto effect = limit({.radius_m = 0.04, .damping_N_s_per_m = 10});
  const Point outside(0.15, 0, 0);
  EXPECT_LT((test::force_N(*effect, {.position_m = outside, .velocity_m_per_s = {0.2, 1, 0}}) - Point(-7, 0, 0)).norm(),
            1e-12);
  EXPECT_EQ(test::force_N(*effect, {.position_m = outside, .velocity_m_per_s = {-9, 0, 0}}), Point(0, 0, 0));
}

TEST(WorkspaceLimit, ReturnsNoEnergyAroundALoop) {
  for (const Room& room : {kBall, kBlock, kBoth}) {
    const test::LoopWork work = test::work_around(*limit(room), test::crooked_loop({0.12, 0, 0}));
    EXPECT_GT(work.moved_J, 1e-4);
    EXPECT_LT(work.share(), 1e-6);
  }
}

TEST(WorkspaceLimit, PushesInwardsFromEverywhere) {
  ASSERT_TRUE(rc::check([] {
    const Point out = test::draw_point(1e3);
    for (const Room& room : {kBall, kBlock, kBoth}) {
      const Point force = test::force_N(*limit(room), {.position_m = Point(0.1, 0, 0) + out});
      RC_ASSERT(force.allFinite());
      RC_ASSERT(force.dot(out) <= 0);
    }
  }));
}

TEST(WorkspaceLimit, RefusesARegionWithoutLimitsOrOfNegativeSize) {
  EXPECT_THROW(limit({}), std::invalid_argument);
  EXPECT_THROW((void)config::completed(workspace_limit_effect().parameters, {{"center_m", Point(Point::Zero())},
                                                                             {"size_m", Point(0.1, -0.1, 0.1)},
                                                                             {"stiffness_N_per_m", 500.0}}),
               config::ValueError);
}

}  // namespace
}  // namespace forcebound::scene
