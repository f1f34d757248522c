#include "forcebound/scene/effects/surface.hpp"

#include <gtest/gtest.h>

#include "tests/support/effect_probe.hpp"

namespace forcebound::scene {
namespace {

std::unique_ptr<Effect> surface(double stiffness_N_per_m, double damping_N_s_per_m, double stiffening_N_per_m2 = 0) {
  return surface_effect().make({{"stiffness_N_per_m", stiffness_N_per_m},
                                {"damping_N_s_per_m", damping_N_s_per_m},
                                {"stiffening_N_per_m2", stiffening_N_per_m2}});
}

Probe probe(double penetration_m, const Point& velocity_m_per_s) {
  return {.position_m = Point::Zero(),
          .velocity_m_per_s = velocity_m_per_s,
          .normal = Point::UnitZ(),
          .penetration_m = penetration_m};
}

TEST(Surface, PushesOutLikeASpring) {
  const auto effect = surface(2000, 0);
  EXPECT_TRUE(test::force_N(*effect, probe(0.003, {1, 2, 3})).isApprox(Point(0, 0, 6), 1e-15));
}

TEST(Surface, StiffensWithDepth) {
  const auto effect = surface(2000, 0, 1e6);
  EXPECT_TRUE(test::force_N(*effect, probe(0.003, Point::Zero())).isApprox(Point(0, 0, 6 + 9), 1e-15));
}

TEST(Surface, DampsAlongTheNormalOnly) {
  const auto effect = surface(2000, 5);
  EXPECT_TRUE(test::force_N(*effect, probe(0.003, {0, 0, -0.2})).isApprox(Point(0, 0, 7), 1e-15));
  EXPECT_TRUE(test::force_N(*effect, probe(0.003, {9, -9, 0.2})).isApprox(Point(0, 0, 5), 1e-15));
}

TEST(Surface, NeverPulls) {
  const auto effect = surface(2000, 5);
  EXPECT_EQ(test::force_N(*effect, probe(0.003, {0, 0, 100})), Point(0, 0, 0));
}

TEST(Surface, LooksAtVelocityOnlyIfItDamps) {
  EXPECT_FALSE(surface(1, 0)->facts().inputs.velocity);
  EXPECT_TRUE(surface(1, 0.1)->facts().inputs.velocity);
}

}  // namespace
}  // namespace forcebound::scene
