#include "forcebound/scene/effects/attractor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/field_checks.hpp"
#include "tests/support/random_points.hpp"

namespace forcebound::scene {
namespace {

const Point kCenter(0.01, -0.02, 0.03);

/// F = 3 N, R = 20 mm.
std::unique_ptr<Effect> attractor(const std::string& falloff) {
  return attractor_effect().make(
      {{"center_m", kCenter}, {"force_N_max", 3.0}, {"radius_m", 0.02}, {"falloff", falloff}});
}

Point pull_N(const Effect& effect, const Point& out_m) {
  return test::force_N(effect, {.position_m = kCenter + out_m});
}

TEST(Attractor, LinearGrowsUpToItsRadiusAndStaysThere) {
  const auto effect = attractor("linear");
  EXPECT_LT((pull_N(*effect, {0.005, 0, 0}) - Point(-0.75, 0, 0)).norm(), 1e-14);
  EXPECT_LT((pull_N(*effect, {0, 0.02, 0}) - Point(0, -3, 0)).norm(), 1e-14);
  EXPECT_LT((pull_N(*effect, {0, 0, -2}) - Point(0, 0, 3)).norm(), 1e-13);
}

TEST(Attractor, InverseSquareIsStrongestAtItsRadiusOverRootTwo) {
  const auto effect = attractor("inverse_square");
  const double strongest_m = 0.02 / std::sqrt(2);
  EXPECT_NEAR(pull_N(*effect, {strongest_m, 0, 0}).x(), -3, 1e-13);
  EXPECT_GT(pull_N(*effect, {1.01 * strongest_m, 0, 0}).x(), -3);
  EXPECT_GT(pull_N(*effect, {0.99 * strongest_m, 0, 0}).x(), -3);
}

TEST(Attractor, InverseSquareFallsWithTheSquareOfTheDistanceFarAway) {
  const auto effect = attractor("inverse_square");
  EXPECT_NEAR(pull_N(*effect, {0, 200, 0}).norm() / pull_N(*effect, {0, 400, 0}).norm(), 4, 1e-6);
}

class EveryAttractor : public testing::TestWithParam<std::string> {};

TEST_P(EveryAttractor, IsZeroAtTheVeryPoint) {
  EXPECT_EQ(pull_N(*attractor(GetParam()), Point::Zero()), Point(0, 0, 0));
}

TEST_P(EveryAttractor, IsFiniteAndPullsInwardsNeverHarderThanItsMost) {
  const auto effect = attractor(GetParam());
  ASSERT_TRUE(rc::check([&] {
    const Point out = std::pow(10.0, *rc::gen::inRange(-300, 150)) * test::draw_point(1);
    const Point force = test::force_N(*effect, {.position_m = kCenter + out});
    RC_ASSERT(force.allFinite());
    RC_ASSERT(force.norm() <= 3 * (1 + 1e-12));
    RC_ASSERT(force.dot(out / std::max(out.norm(), 1e-300)) <= 0);
  }));
}

TEST_P(EveryAttractor, ReturnsNoEnergyAroundALoop) {
  const auto effect = attractor(GetParam());
  EXPECT_LT(test::work_around(*effect, test::crooked_loop(kCenter)).share(), 1e-7);
  EXPECT_LT(test::work_around(*effect, test::crooked_loop(Point(1, 0, 0))).share(), 1e-7);
}

TEST_P(EveryAttractor, StatesTheStiffnessItHasAtItsPoint) {
  const auto effect = attractor(GetParam());
  const double step_m = 1e-7;
  EXPECT_NEAR(-pull_N(*effect, {step_m, 0, 0}).x() / step_m / effect->facts().stiffness_N_per_m, 1, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Attractor, EveryAttractor, testing::Values("linear", "inverse_square"));

/// A force without a potential.
class Swirl final : public Effect {
 public:
  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    reaction.force_N += Point(-probe.position_m.y(), probe.position_m.x(), 0);
  }
};

TEST(WorkAroundALoop, ShowsASwirl) {
  EXPECT_GT(test::work_around(Swirl(), test::crooked_loop(Point::Zero())).share(), 0.5);
}

}  // namespace
}  // namespace forcebound::scene
