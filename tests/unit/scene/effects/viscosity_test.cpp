#include "forcebound/scene/effects/viscosity.hpp"

#include <gtest/gtest.h>

#include "tests/support/effect_probe.hpp"
#include "tests/support/random_points.hpp"

namespace forcebound::scene {
namespace {

std::unique_ptr<Effect> viscosity(double damping_N_s_per_m) {
  return viscosity_effect().make({{"damping_N_s_per_m", damping_N_s_per_m}});
}

TEST(Viscosity, ResistsEveryMotionInProportion) {
  const auto effect = viscosity(2.5);
  EXPECT_EQ(test::force_N(*effect, {.velocity_m_per_s = {0.1, -0.2, 0.4}}), Point(-0.25, 0.5, -1));
  EXPECT_EQ(test::force_N(*effect, {.position_m = {1, 2, 3}}), Point(0, 0, 0));
}

TEST(Viscosity, TakesEnergyOnly) {
  const auto effect = viscosity(7);
  ASSERT_TRUE(rc::check([&] {
    const Point velocity = test::draw_point(10);
    RC_ASSERT(test::force_N(*effect, {.velocity_m_per_s = velocity}).dot(velocity) <= 0);
  }));
}

TEST(Viscosity, LooksAtVelocityAndFillsSpace) {
  EXPECT_TRUE(viscosity(1)->facts().inputs.velocity);
  EXPECT_FALSE(viscosity(1)->facts().inputs.time);
  EXPECT_EQ(viscosity_effect().place, EffectPlace::space);
}

}  // namespace
}  // namespace forcebound::scene
