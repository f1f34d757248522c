#include "forcebound/scene/effects/constant_force.hpp"

#include <gtest/gtest.h>

#include "tests/support/field_checks.hpp"

namespace forcebound::scene {
namespace {

TEST(ConstantForce, IsTheSameEverywhereAndAlways) {
  const auto effect = constant_force_effect().make({{"force_N", Point(1, -2, 0.5)}});
  EXPECT_EQ(test::force_N(*effect, {}), Point(1, -2, 0.5));
  EXPECT_EQ(test::force_N(*effect, {.position_m = {1e6, 3, -7}, .velocity_m_per_s = {1, 1, 1}, .time_s = 9}),
            Point(1, -2, 0.5));
}

TEST(ConstantForce, ReturnsNoEnergyAroundALoop) {
  const auto effect = constant_force_effect().make({{"force_N", Point(1, -2, 0.5)}});
  EXPECT_LT(test::work_around(*effect, test::crooked_loop(Point::Zero())).share(), 1e-12);
}

TEST(ConstantForce, NeedsNoInputAndNoState) {
  const EffectFacts facts = constant_force_effect().make({{"force_N", Point(1, 0, 0)}})->facts();
  EXPECT_FALSE(facts.inputs.velocity || facts.inputs.time || facts.inputs.pressure);
  EXPECT_EQ(facts.state_bytes, 0U);
  EXPECT_EQ(facts.stiffness_N_per_m, 0);
}

TEST(ConstantForce, IsNoEnergySourceButFadesWithoutServer) {
  const EffectFacts facts = constant_force_effect().make({{"force_N", Point(1, 0, 0)}})->facts();
  EXPECT_FALSE(facts.drives);
  EXPECT_TRUE(facts.fades_without_server);
}

}  // namespace
}  // namespace forcebound::scene
